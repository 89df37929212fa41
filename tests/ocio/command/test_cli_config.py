"""`crfnet config` from the shell: what it prints, and one line for anything that is wrong."""

import json
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from crfnet.configs.portable import portable_config
from tests.helpers.configs import converted, loaded
from tests.helpers.folders import listed, tree
from tests.helpers.images import read_image
from tests.helpers.looks import LUT, NAME, STUDIO, space_of, write_look


@pytest.fixture
def folder(tmp_path):
    return write_look(tmp_path / "look", exposure=1)


def test_an_estimate_goes_into_a_studios_config(crfnet, look, plate, oiiotool, linear, tmp_path, tolerance):
    """From the photograph to a config that oiiotool reads the plate and its linear file with."""
    out = tmp_path / "show.ocio"
    done = crfnet("config", "add", "--base", STUDIO, "--out", out, look, "--view")
    assert (done.code, done.err) == (0, "")
    assert done.out.splitlines()[:2] == [f"Written: {out}", "CRF plate: show_camera_response/plate.spi1d"]
    convert = ("--colorconvert", "CRF plate", "lin_rec709_scene")
    oiiotool("--colorconfig", out, plate, *convert, "-d", "float", "-o", tmp_path / "a.exr")
    np.testing.assert_allclose(read_image(tmp_path / "a.exr"), linear, atol=tolerance.plate)
    found = loaded(out)
    assert space_of(found, str(look / "plate_linear.exr")) == "Linear Rec.709 (sRGB)"
    assert space_of(found, "PLATE.JPG") == "CRF plate"


def test_the_view_gives_the_plate_back_bit_for_bit(crfnet, look, plate, oiiotool, tmp_path):
    """Plate to linear half EXR, and through the view "as photographed" to 8 bits: the codes of the JPEG."""
    out = tmp_path / "show.ocio"
    assert crfnet("config", "add", "--base", STUDIO, "--out", out, look, "--view").code == 0
    start = ("--colorconfig", out)
    oiiotool(*start, plate, "--colorconvert", "CRF plate", "ACEScg", "-d", "half", "-o", tmp_path / "linear.exr")
    display = ("--iscolorspace", "ACEScg", "--ociodisplay", "sRGB - Display", "As photographed (CRF plate)")
    oiiotool(*start, tmp_path / "linear.exr", *display, "-d", "uint8", "-o", tmp_path / "back.png")
    back, codes = read_image(tmp_path / "back.png", kind="uint8"), read_image(plate, kind="uint8")
    np.testing.assert_array_equal(back, codes)


def test_the_config_of_an_estimate_has_the_views(look):
    views = list(loaded(look / "config.ocio").getViews("sRGB"))
    assert views == ["Standard", "Raw", "As photographed (CRF plate)", "As photographed with roll-off (CRF plate)"]


def test_add_list_and_remove(crfnet, folder, tmp_path):
    config = tmp_path / "show" / "show.ocio"
    config.parent.mkdir()
    config.write_text(portable_config([]).serialize())
    before = tree(config.parent)
    done = crfnet("config", "add", "--base", config, folder)
    assert f"The config as it was: {config.with_name('show.before-camera-response.ocio')}" in done.out
    again = crfnet("config", "add", "--base", config, folder / "plate01.spi1d")
    assert again.out.startswith(f"Nothing to do, all of it is there already: {config}")
    found = crfnet("config", "list", config)
    assert found.out.splitlines()[0] == f"{NAME}: show_camera_response/plate01.spi1d, +1 stops"
    document = json.loads(crfnet("config", "list", config, "--json").out)
    assert [plate["exposure"] for plate in document["plates"]] == [1]
    done = crfnet("config", "remove", config, NAME)
    assert done.out == f"Taken out of {config}: {NAME}\n"
    assert tree(config.parent) == before
    assert crfnet("config", "list", config).out == f"{config}: has no plates\n"


def test_the_documents_say_what_was_done(crfnet, folder, tmp_path):
    out = tmp_path / "show"
    added = json.loads(crfnet("config", "add", "--base", STUDIO, "--out", out, folder, "--json").out)
    assert added["config"] == str(out / "config.ocio")
    assert (added["is_changed"], added["backup"], added["notes"]) == (True, None, [])
    assert list(added["plates"][0]["rules"].values()) == [NAME, "Linear Rec.709 (sRGB)"]
    removed = json.loads(crfnet("config", "remove", out, NAME, "--json").out)
    assert [plate["name"] for plate in removed["plates"]] == [NAME]


def test_the_printed_merge_line_works(crfnet, folder, tmp_path):
    done = crfnet("config", "overlay", "--base", STUDIO, "--out", tmp_path / "my show" / "overlay.ocio", folder)
    assert done.code == 0
    tool, *arguments = shlex.split(done.out.splitlines()[-1])
    path = Path(sys.executable).with_name(tool)
    if not path.exists():
        pytest.skip("OpenColorIO merges configs from version 2.5 on")
    subprocess.run([str(path), *arguments], check=True, capture_output=True)
    found = loaded(tmp_path / "my show" / "merged.ocio")
    np.testing.assert_allclose(
        converted(found, NAME, "lin_rec709_scene", [[0.5] * 3]), 2 * LUT.apply([[0.5] * 3]), atol=1e-5
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("add", "--base", STUDIO, "{look}"), "is built into OpenColorIO and cannot be changed; add --out FILE.ocio"),
        (("add", "--base", "nowhere", "{look}"), "nowhere: is no config, no built-in config's name, and no Blender"),
        (("add", "--base", STUDIO, "--out", "", "{look}"), "is empty; give a name, or . for the current folder"),
        (("add", "--base", STUDIO, "--out", "{out}", "{out}"), "is no document of crfnet estimate"),
        (("add", "{look}"), "the following arguments are required: --base"),
        (("add", "--base", STUDIO, "--out", "{out}", "{look}", "{look2}", "--rule", "a"), "are for one plate"),
        (("add", "--base", STUDIO, "--out", "{out}", "{look}", "--rule", "a", "--no-rules"), "are for one plate"),
        (("add", "--base", STUDIO, "--out", "{out}", "{look}", "--rule", ""), "PATTERN is empty"),
        (("overlay", "--base", STUDIO, "{look}"), "the following arguments are required: --out"),
        (("remove", STUDIO, "CRF a"), "is built into OpenColorIO and cannot be changed"),
        (("list", "nowhere.ocio"), "nowhere.ocio: there is no such config; check the name"),
        ((), "the following arguments are required: ACTION"),
    ],
)
def test_anything_wrong_is_one_line(crfnet, folder, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    names = {"look": folder, "look2": write_look(tmp_path / "two", ["b.jpg"]), "out": tmp_path / "out.ocio"}
    before = listed(tmp_path)
    done = crfnet("config", *(argument.format(**names) for argument in arguments))
    assert (done.code, done.out, done.err.count("\n")) == (2, "", 1)
    assert message in done.err
    assert listed(tmp_path) == before

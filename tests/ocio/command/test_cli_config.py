import json
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.helpers.configs import loaded
from tests.helpers.folders import tree
from tests.helpers.images import read_image
from tests.helpers.looks import NAME, STUDIO, space_of, write_look


@pytest.fixture
def folder(tmp_path):
    return write_look(tmp_path / "look", exposure=1)


def test_an_estimate_goes_into_a_copy_of_a_studios_config(crfnet, look, plate, oiiotool, linear, tmp_path, tolerance):
    out = tmp_path / "show"
    printed = crfnet("config", "add", "--base", STUDIO, "--out", out, look).printed
    assert printed.splitlines()[:2] == [f"Written: {out / 'config.ocio'}", "CRF plate: plate.spi1d"]
    convert = ("--colorconvert", "CRF plate", "lin_rec709_scene")
    oiiotool("--colorconfig", out / "config.ocio", plate, *convert, "-d", "float", "-o", tmp_path / "a.exr")
    np.testing.assert_allclose(read_image(tmp_path / "a.exr"), linear, atol=tolerance.plate)
    found = loaded(out / "config.ocio")
    assert space_of(found, str(look / "plate_linear.exr")) == "Linear Rec.709 (sRGB)"
    assert space_of(found, "PLATE.JPG") == "CRF plate"


def test_add_and_list(crfnet, folder, tmp_path):
    others = (folder / ".", folder / "plate01.json", folder / "plate01.spi1d")  # the same once more
    assert crfnet("config", "add", "--base", STUDIO, "--out", tmp_path / "show", folder, *others).code == 0
    assert crfnet("config", "list", tmp_path / "show").out.splitlines()[0] == f"{NAME}: plate01.spi1d, +1 stops"
    document = json.loads(crfnet("config", "list", tmp_path / "show", "--json").out)
    assert [plate["exposure"] for plate in document["plates"]] == [1], "one plate"
    assert list(document["plates"][0]["rules"].values()) == [NAME, "Linear Rec.709 (sRGB)"]
    assert crfnet("config", "list", STUDIO).out == f"ocio://{STUDIO}: has no plates\n"


def test_files_without_a_rule_are_named(crfnet, folder, tmp_path):
    looks = [folder, write_look(tmp_path / "night"), write_look(tmp_path / "day", ["IMG_0042.JPG"])]
    done = crfnet("config", "add", "--base", STUDIO, "--out", tmp_path / "a", *looks)
    notes = [line for line in done.out.splitlines() if line.startswith("note: ")]
    assert [note.split()[4] for note in notes] == ["plate01.jpg", "IMG_0042.JPG"]
    assert "no file rule" not in done.out
    assert "[pP][lL][aA][tT][eE]01\\.[jJ][pP][gG])" not in done.out
    document = json.loads(crfnet("config", "add", "--base", STUDIO, "--out", tmp_path / "b", *looks, "--json").out)
    assert document["config"] == str(tmp_path / "b" / "config.ocio")
    assert document["without_rule"] == ["plate01.jpg", "IMG_0042.JPG"]
    assert [plate["name"] for plate in document["plates"]] == [NAME, f"{NAME} (night)", "CRF IMG_0042"]


def test_a_base_of_profile_1_is_said_to_have_no_rules(crfnet, tmp_path):
    views, spaces = "{d: [!<View> {name: v, colorspace: lin_srgb}]}", "[!<ColorSpace> {name: lin_srgb}]"
    (tmp_path / "base.ocio").write_text(f"ocio_profile_version: 1\ndisplays: {views}\ncolorspaces: {spaces}\n")
    look = write_look(tmp_path / "look")
    done = crfnet("config", "add", "--base", tmp_path / "base.ocio", "--out", tmp_path / "show", look)
    assert done.out.endswith("plate01.jpg no space of its own: its base, of profile version 1, has no file rules\n")


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
@pytest.mark.parametrize("line", ["info plate01.spi1d", "config list config.ocio", "config add --base . --out x ."])
def test_a_current_folder_whose_name_is_not_unicode_is_named(crfnet, folder, tmp_path, monkeypatch, line):
    shutil.copytree(folder, tmp_path / os.fsdecode(b"\xff"))
    monkeypatch.chdir(tmp_path / os.fsdecode(b"\xff"))
    done = crfnet(*line.split())
    assert (done.refusal, "\\udcff" in done.err) == ("name_not_utf8", True)


def test_plates_that_a_replaced_config_no_longer_has_are_named(crfnet, folder, tmp_path):
    add = ("config", "add", "--base", STUDIO, "--out", tmp_path / "show", "--overwrite")
    both = (folder, write_look(tmp_path / "other", ["other.jpg"]))
    for looks in (both, both):
        assert "was replaced" not in crfnet(*add, *looks).out
    assert 'config.ocio was replaced and no longer has "CRF other"; ' in crfnet(*add, folder).out
    assert json.loads(crfnet(*add, both[1], "--json").out)["dropped"] == [NAME]


def test_the_merge_line_of_the_documents_works(folder, root, tmp_path):
    """docs/USAGE.md: with OpenColorIO's own tool, the plates of an estimate over a studio's config."""
    tool = Path(sys.executable).with_name("ociomergeconfigs")
    if not tool.exists():
        pytest.skip("OpenColorIO merges configs from version 2.5 on")
    text = (root / "docs" / "USAGE.md").read_text(encoding="utf-8")
    merge = text[text.index("ociom_version") :].split("```")[0]
    (folder / "merge.ociom").write_text(merge.replace("/studio/config.ocio", f"ocio://{STUDIO}"))
    (line,) = (line for line in text.splitlines() if line.strip().startswith("ociomergeconfigs"))
    subprocess.run([tool, *shlex.split(line)[1:]], check=True, capture_output=True, cwd=folder)
    assert loaded(folder / "merged.ocio").getColorSpace(NAME) is not None


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ("add --base BASE LOOK", "usage"),
        ("add --base nowhere --out OUT LOOK", "config_unknown"),
        ("add --base BASE --out OUT OUT", "not_a_look"),
        ("add --base LOOK --out LOOK LOOK --overwrite", "base_would_change"),
        ("add LOOK --out OUT", "usage"),
        ("list nowhere.ocio", "no_such_file"),
        ("", "usage"),
    ],
)
def test_anything_wrong_is_one_line(crfnet, folder, tmp_path, monkeypatch, arguments, code):
    monkeypatch.chdir(tmp_path)
    names = {"BASE": STUDIO, "LOOK": folder, "OUT": tmp_path / "out"}
    before = tree(tmp_path)
    done = crfnet("config", *(names.get(word, word) for word in shlex.split(arguments)))
    assert (done.refusal, done.out) == (code, "")
    assert tree(tmp_path) == before

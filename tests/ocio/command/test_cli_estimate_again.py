"""`crfnet estimate` into the folder of an earlier run."""

import json

import pytest

from crfnet.cli.commands.printing import print_stale
from tests.helpers.configs import loaded
from tests.helpers.folders import listed


def test_files_of_an_earlier_run_that_no_longer_fit_are_named(estimate, plate, tmp_path):
    assert estimate(plate, "--forward").code == 0
    left = ["plate_forward.spi1d", "plate_forward.cube", "plate_forward.clf", "plate_linear.exr"]
    done = estimate(plate, "--no-linear", "--prior", "any", "--overwrite")
    assert (
        f"Warning: left from an earlier run, and not part of this estimate: {', '.join(left)}; remove them." in done.out
    )
    assert set(left) < set(listed(tmp_path / "out"))
    assert json.loads(estimate(plate, "--no-linear", "--overwrite", "--json").out)["left"] == left
    assert "from an earlier run" not in estimate(plate, "--forward", "--overwrite").out


def test_so_they_are_of_each_of_many_photographs(estimate, photographs, tmp_path):
    each = (photographs, "--each", "--no-linear", "--workers", "1")
    assert estimate(*each, "--forward").code == 0
    endings = [".spi1d", ".cube", ".clf"]
    left = [f"{stem}_forward{ending}" for stem in ("a", "b", "day 2/a") for ending in endings]
    done = estimate(*each, "--overwrite")
    assert (
        f"Warning: left from an earlier run, and not part of these estimates: {', '.join(left)}; remove them."
        in done.out
    )
    assert json.loads(estimate(*each, "--overwrite", "--json").out)["left"] == left
    assert all((tmp_path / "out" / name).exists() for name in left)
    assert "from an earlier run" not in estimate(*each, "--forward", "--overwrite").out


def test_those_of_another_photograph_are_not_named(estimate, photographs):
    (photographs / "b.JPG").rename(photographs / "a_forward.jpg")
    each = (photographs, "--each", "--no-linear", "--workers", "1")
    assert estimate(*each).code == 0
    assert "from an earlier run" not in estimate(*each, "--overwrite").out
    assert "from an earlier run" not in estimate(photographs / "a.jpg", "--no-linear", "--overwrite").out


def test_color_spaces_that_a_replaced_config_no_longer_has_are_named(estimate, crfnet, plate, tmp_path):
    other, out = tmp_path / "other.jpg", tmp_path / "out"
    other.write_bytes(plate.read_bytes())
    assert "was replaced" not in estimate(plate, "--no-linear").out
    assert "was replaced" not in estimate(plate, "--no-linear", "--overwrite").out
    words = f'Warning: config.ocio was replaced, and does not have "CRF plate" any more; crfnet config add --base {out}'
    assert words in estimate(other, "--no-linear", "--overwrite").out
    both = tmp_path / "both"
    assert crfnet("config", "add", "--base", out / "config.ocio", "--out", both, out / "plate.json").code == 0
    config = loaded(both / "config.ocio")
    assert {"CRF plate", "CRF other"} < set(config.getColorSpaceNames())
    printed = estimate(plate, "--no-linear", "--overwrite", "--json").out
    assert json.loads(printed)["dropped"] == ["CRF other"]


@pytest.mark.parametrize("content", [b"no config", b"ocio_profile_version: \xe4\xff", b"\xff\xfe\0\1", b""])
def test_a_config_that_nobody_can_read_is_replaced(estimate, plate, tmp_path, content):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "config.ocio").write_bytes(content)
    done = estimate(plate, "--no-linear", "--overwrite")
    assert (done.code, done.err) == (0, "")
    assert "CRF plate" in loaded(tmp_path / "out" / "config.ocio").getColorSpaceNames()


def test_a_config_with_names_that_are_not_utf_8_is_replaced(estimate, plate, tmp_path):
    estimate(plate, "--no-linear")
    config = tmp_path / "out" / "config.ocio"
    config.write_bytes(config.read_bytes().replace(b"CRF plate", b"CRF pl\xe4te"))
    assert estimate(plate, "--no-linear", "--overwrite").code == 0
    assert "CRF plate" in loaded(config).getColorSpaceNames()


def test_of_many_files_that_no_longer_fit_the_first_are_named(capsys):
    print_stale([f"{number}.exr" for number in range(25)], "these estimates")
    out = capsys.readouterr().out
    assert out.startswith("Warning: left from an earlier run, and not part of these estimates: 0.exr, 1.exr, ")
    assert out.endswith(", 19.exr and 5 more; remove them.\n")

"""`crfnet estimate` into the folder of an earlier run."""

import json

from ocio.commands.printing import print_left
from tests.helpers.folders import listed


def test_files_of_an_earlier_run_that_no_longer_fit_are_named(estimate, plate, tmp_path):
    assert estimate(plate, "--forward").code == 0
    left = ["plate_forward.spi1d", "plate_forward.cube", "plate_forward.clf", "plate_linear.exr"]
    done = estimate(plate, "--no-linear", "--prior", "any", "--overwrite")
    assert f"Warning: of an earlier run, and not of this estimate, are {', '.join(left)}; remove them." in done.out
    assert set(left) < set(listed(tmp_path / "out"))
    assert json.loads(estimate(plate, "--no-linear", "--overwrite", "--json").out)["left"] == left
    assert "of an earlier run" not in estimate(plate, "--forward", "--overwrite").out


def test_so_they_are_of_each_of_many_photographs(estimate, photographs, tmp_path):
    each = (photographs, "--each", "--no-linear", "--workers", "1")
    assert estimate(*each, "--forward").code == 0
    endings = [".spi1d", ".cube", ".clf"]
    left = [f"{stem}_forward{ending}" for stem in ("a", "b", "day 2/a") for ending in endings]
    done = estimate(*each, "--overwrite")
    assert f"Warning: of an earlier run, and not of these estimates, are {', '.join(left)}; remove them." in done.out
    assert json.loads(estimate(*each, "--overwrite", "--json").out)["left"] == left
    assert all((tmp_path / "out" / name).exists() for name in left)
    assert "of an earlier run" not in estimate(*each, "--forward", "--overwrite").out


def test_those_of_another_photograph_are_not_named(estimate, photographs):
    (photographs / "b.JPG").rename(photographs / "a_forward.jpg")
    each = (photographs, "--each", "--no-linear", "--workers", "1")
    assert estimate(*each).code == 0
    assert "of an earlier run" not in estimate(*each, "--overwrite").out
    assert "of an earlier run" not in estimate(photographs / "a.jpg", "--no-linear", "--overwrite").out


def test_of_many_files_that_no_longer_fit_the_first_are_named(capsys):
    print_left([f"{number}.exr" for number in range(25)], "these estimates")
    out = capsys.readouterr().out
    assert out.startswith("Warning: of an earlier run, and not of these estimates, are 0.exr, 1.exr, ")
    assert out.endswith(", 19.exr and 5 more; remove them.\n")

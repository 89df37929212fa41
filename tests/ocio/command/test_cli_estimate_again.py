"""`crfnet estimate` into the folder of an earlier run."""

import json

from tests.helpers.folders import listed


def test_files_of_an_earlier_run_that_no_longer_fit_are_named(estimate, plate, tmp_path):
    assert estimate(plate, "--forward").code == 0
    left = ["plate_forward.spi1d", "plate_forward.cube", "plate_forward.clf", "plate_linear.exr"]
    done = estimate(plate, "--no-linear", "--prior", "any", "--overwrite")
    assert f"Warning: of an earlier run, and not of this estimate, are {', '.join(left)}; remove them." in done.out
    assert set(left) < set(listed(tmp_path / "out"))
    assert json.loads(estimate(plate, "--no-linear", "--overwrite", "--json").out)["left"] == left
    assert "of an earlier run" not in estimate(plate, "--forward", "--overwrite").out

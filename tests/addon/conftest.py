"""Jobs made by hand, for the tests of the add-on that need no Blender."""

from pathlib import Path

import numpy as np
import pytest

from blender_addon.work.job import Anchor, ApplyMode, Estimation, Exposure, Job, Output, Plate
from crfnet.configs.portable import portable_config
from crfnet.options import EstimateOptions
from tests.helpers.images import write_image


def plate_from_file(path, *, is_sequence=False, name="", color_space="sRGB"):
    """Return the plate of a file, which Blender calls by this name."""
    names = {"datablock_name": name or path.name, "uid": 1}
    return Plate.from_file(path, is_sequence=is_sequence, color_space=color_space, folder=path.parent, **names)


@pytest.fixture
def running_config(tmp_path) -> Path:
    """The config of a Blender that does not exist; its color spaces are as in every exported config."""
    path = tmp_path / "running" / "config.ocio"
    path.parent.mkdir()
    path.write_text(portable_config([]).serialize(), encoding="utf-8")
    return path


@pytest.fixture
def make_job(plate_file, fixed_model, running_config, tmp_path):
    """Return the job of a file, by default a bake of `plate_file` with the fixed model."""

    def make(
        path=plate_file,
        *,
        is_sequence=False,
        color_space="sRGB",
        mode=ApplyMode.BAKE,
        folder=tmp_path / "out",
        overwrite=False,
        anchor=Anchor.WHITE,
        gray=0.5,
        stops=0.0,
        is_forced=False,
        stored=None,
    ):
        return Job(
            plate=plate_from_file(path, is_sequence=is_sequence, color_space=color_space),
            estimation=Estimation(options=EstimateOptions(model=fixed_model), is_forced=is_forced, stored=stored),
            exposure=Exposure(anchor=anchor, gray=gray, stops=stops),
            output=Output(mode=mode, folder=folder, depth="float", overwrite=overwrite),
            config=str(running_config),
        )

    return make


@pytest.fixture
def sequence_file(tmp_path, codes) -> Path:
    """The first of eight frames; the fourth is missing."""
    folder = tmp_path / "sequence"
    folder.mkdir()
    for number in (1, 2, 3, 5, 6, 7, 8, 9):
        write_image(folder / f"shot.{number:04d}.png", np.roll(codes, number, axis=0))
    return folder / "shot.0001.png"

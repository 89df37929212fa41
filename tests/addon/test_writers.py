"""The files of a job: their names and contents; all of them or none."""

import dataclasses

import numpy as np
import pytest

from blender_addon.work import writers
from blender_addon.work.errors import AddonError, CancelledError
from blender_addon.work.frame_files import frames_of, read_plate_frame
from blender_addon.work.job import ApplyMode
from crfnet.errors import ConfigError, PlateError
from crfnet.luts.files import WRITERS, read_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet.luts.rgb_lut import lut_identity
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import loaded
from tests.helpers.folders import listed, tree
from tests.helpers.images import read_image, write_image
from tests.helpers.refusals import refused

CURVE = ResponseCurve.gamma(2.2)
LUT = inverse_response_lut(CURVE)


def write(job, progress=None):
    return writers.write(job, LUT, 0.0, lambda: frames_of(job.plate), progress)


def cancel_at_the_third(done, _total):
    if done >= 3:
        raise CancelledError("Cancelled; nothing was changed")


@pytest.mark.parametrize("before", ["shot.1-2.", "shot.1-2x", "take#_", "a%02d_", "b$F4.", "[1-2]@@."])
def test_the_name_before_the_frame_number_may_look_like_a_placeholder(make_job, tmp_path, codes, before):
    """Blender knows which number is the frame's, so its name is not read as a pattern."""
    files = [write_image(tmp_path / f"{before}{number:04d}.png", np.roll(codes, number, 0)) for number in (1, 2, 4)]
    write_image(tmp_path / "shot.1-20007.png", codes)
    job = make_job(files[0], is_sequence=True)
    baked = write(job)
    assert frames_of(job.plate).paths == tuple(files)
    assert frames_of(job.plate).numbers == (1, 2, 4)
    assert [path.name[-9:] for path in baked.files] == [".0001.exr", ".0002.exr", ".0004.exr"]
    assert np.abs(read_image(baked.files[2]) - CURVE.inverse(np.roll(codes, 4, 0) / 255)).max() < 1e-5


def test_a_cancelled_bake_leaves_what_was_there(make_job, sequence_file, tmp_path):
    """Files of an earlier run stay as they were, also those that would be replaced by then."""
    job = make_job(sequence_file, is_sequence=True, overwrite=True)
    earlier = dict.fromkeys(["shot_linear.0001.exr", "shot_linear.0007.exr"], b"earlier")
    (tmp_path / "out").mkdir()
    for name, content in earlier.items():
        (tmp_path / "out" / name).write_bytes(content)
    with pytest.raises(CancelledError):
        write(job, cancel_at_the_third)
    assert tree(tmp_path / "out") == earlier


@pytest.mark.parametrize(
    ("alpha_mode", "color", "alpha"),
    [
        ("STRAIGHT", (0.3, 0.2), (0, 0.5)),
        ("PREMUL", (0, 0.4), (0, 0.5)),
        ("CHANNEL_PACKED", (0.3, 0.2), (0, 0.5)),
        ("NONE", (0.3, 0.2), None),
    ],
)
@pytest.mark.parametrize("suffix", [".exr", ".png"])
def test_alpha_is_taken_as_by_blender(tmp_path, alpha_mode, color, alpha, suffix):
    """Of two pixels that are stored as 0.3 and 0.2; also what an OpenEXR file holds under an alpha of 0."""
    stored = np.array([[(0.3, 0.3, 0.3, 0), (0.2, 0.2, 0.2, 0.5)]], np.float32)
    samples = stored if suffix == ".exr" else np.rint(stored * 65535).astype(np.uint16)
    tags = {".exr": {"colorInteropID": "srgb_rec709_display"}, ".png": {"oiio:UnassociatedAlpha": 1}}
    frame = read_plate_frame(write_image(tmp_path / f"a{suffix}", samples, **tags[suffix]), alpha_mode)
    np.testing.assert_allclose(frame.samples[0, :, 0] / frame.largest, color, atol=1e-4)
    assert (frame.alpha is None) == (alpha is None)
    assert frame.is_coverage == (alpha_mode != "CHANNEL_PACKED")
    if alpha is not None:
        np.testing.assert_allclose(frame.alpha[0], alpha, atol=1e-4)


def test_alpha_that_is_no_coverage_is_written_in_the_same_pass(make_job, tmp_path, codes):
    path = write_image(tmp_path / "a.png", np.dstack([codes, codes[..., :1]]), oiio__UnassociatedAlpha=1)
    job, calls, target = make_job(path), [], tmp_path / "out" / "a_linear.exr"
    job = dataclasses.replace(job, plate=dataclasses.replace(job.plate, alpha_mode="CHANNEL_PACKED"))
    assert write(job, lambda *call: calls.append(call)) == writers.Written((target,))
    assert calls[-1] == (1, 1)
    assert np.abs(read_image(target)[..., :3] - CURVE.inverse(codes / 255)).max() < 1e-5
    np.testing.assert_array_equal(read_image(target)[..., 3], codes[..., 0] / np.float32(255))


def test_a_frame_that_fails_takes_the_others_back(make_job, sequence_file, tmp_path):
    sequence_file.with_name("shot.0005.png").write_bytes(b"no picture")
    with refused(PlateError, "frames_failed", count=1, frames="5"):
        write(make_job(sequence_file, is_sequence=True))
    assert not (tmp_path / "out").exists()


def test_an_export_is_that_of_the_command_and_built_on_the_running_config_which_stays(
    make_job, running_config, tmp_path
):
    before = running_config.read_bytes()
    exported = write(make_job(mode=ApplyMode.EXPORT))
    folder = exported.config.parent
    assert folder == tmp_path / "out"
    own = f"plate ({lut_identity(LUT)[-8:]}).spi1d"  # of the config
    assert set(listed(folder)) == {"config.ocio", own, *(f"plate{suffix}" for suffix in WRITERS)}
    assert sorted(exported.files) == sorted(folder.iterdir())
    for suffix in WRITERS:
        np.testing.assert_array_equal(read_lut(folder / f"plate{suffix}").values, LUT.values)
    config = loaded(exported.config)
    assert list(config.getColorSpaceNames()) == [*loaded(running_config).getColorSpaceNames(), "CRF plate"]
    assert running_config.read_bytes() == before
    with refused(ConfigError, "base_would_change"):
        write(make_job(mode=ApplyMode.EXPORT, folder=running_config.parent, overwrite=True))


def test_the_file_rule_is_for_every_frame(make_job, sequence_file, tmp_path):
    job = make_job(sequence_file, is_sequence=True)
    space = writers.color_space(job.plate, writers.output_files(job.plate, tmp_path), 1.5)
    assert (space.name, space.file_patterns, space.exposure) == ("CRF shot", ("shot.#.png",), 1.5)


@pytest.mark.parametrize("mode", [ApplyMode.BAKE, ApplyMode.EXPORT])
def test_a_folder_is_needed_that_can_be_written(make_job, tmp_path, mode):
    with pytest.raises(AddonError, match="choose one under Folder"):
        write(make_job(mode=mode, folder=None))
    (tmp_path / "file").write_text("")
    with refused(PlateError, "not_a_folder"):
        write(make_job(mode=mode, folder=tmp_path / "file" / "look"))

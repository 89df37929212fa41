"""The steps that command and add-on share: estimates, exposure, and files that are written together or not at all."""

import dataclasses
import errno
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from crfnet import pipeline
from crfnet.defaults import FRAMES_ANALYZED, LUT_LENGTH
from crfnet.errors import PlateError
from crfnet.luts.lut1d import inverse_response_lut
from crfnet.luts.rgb_lut import RgbLut1D
from crfnet.options import EstimateOptions, PlateOptions
from crfnet.pipeline.batch import network_and_prior
from crfnet.plates.frames import FrameSequence, find_frames
from crfnet.plates.linear import linear_targets, linearize_plates
from crfnet_core.errors import CRFNetError, PhotoError, PriorError
from crfnet_core.posterior import Family
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.folders import listed

LUT = inverse_response_lut(ResponseCurve.gamma(2.2))


class CancelledError(Exception):
    """What a program of its own raises in a progress callback."""


def cancel_after(frames):
    """A progress callback that cancels once so many frames are finished."""

    def progress(done, total):
        if done >= frames:
            raise CancelledError

    return progress


@pytest.fixture(scope="module")
def options(fixed_model):
    return EstimateOptions(model=fixed_model, windows=2)


@pytest.fixture(scope="module")
def network(options):
    return pipeline.load_network(options)


@pytest.fixture(scope="module")
def prior(options):
    return pipeline.load_prior(options)


@pytest.fixture
def sequence(plate, tmp_path):
    """Twelve frames of a plate."""
    for number in range(1, 13):
        shutil.copy(plate, tmp_path / f"shot.{number:04d}.jpg")
    return find_frames(tmp_path / "shot.####.jpg")


class TestEstimates:
    def test_several_frames_stand_for_a_sequence(self, sequence, network, prior, options):
        calls = []
        estimate = pipeline.estimate_frames(
            sequence, network, prior, options, progress=lambda *call: calls.append(call)
        )
        assert len(estimate.photos) == FRAMES_ANALYZED
        assert (estimate.photos[0], estimate.photos[-1]) == ("shot.0001.jpg", "shot.0012.jpg")
        assert len(estimate.windows) == 2 * FRAMES_ANALYZED
        assert calls[-1][0] == calls[-1][1]

    def test_a_single_file_stands_for_itself(self, plate, network, prior, options):
        estimate = pipeline.estimate_frames(FrameSequence((plate,)), network, prior, options)
        assert estimate.photos == ("plate.jpg",)

    def test_a_file_and_its_photograph_give_the_same_response(self, plate, network, prior, options):
        frame = pipeline.estimate_frames(FrameSequence((plate,)), network, prior, options)
        photograph = pipeline.estimate_photographs([plate], network, prior, options)
        np.testing.assert_array_equal(photograph.estimate.curve.brightness, frame.curve.brightness)
        assert [str(facts) for facts in photograph.facts] == ["plate.jpg: 672 x 378, 8 bits"]
        assert (photograph.preview.shape, photograph.stride) == ((378, 672, 3), 1)

    def test_what_the_callback_raises_ends_the_estimate(self, plate, network, prior, options):
        with pytest.raises(CancelledError):
            pipeline.estimate_frames(FrameSequence((plate,)), network, prior, options, progress=cancel_after(1))

    def test_a_frame_that_has_gone_is_named(self, tmp_path, network, prior, options):
        with pytest.raises(PhotoError, match=r"gone\.jpg: there is no such file"):
            pipeline.estimate_frames(FrameSequence((tmp_path / "gone.jpg",)), network, prior, options)

    def test_the_prior_and_the_metadata_follow_the_options(self, plate, network, options, tmp_path):
        (tmp_path / "film only.json").write_text('{"shares": {"film": 1}, "evidence": 0.5}')
        asked = dataclasses.replace(options, prior=tmp_path / "film only.json", use_metadata=False)
        film = pipeline.load_prior(asked)
        for found in (
            pipeline.estimate_frames(FrameSequence((plate,)), network, film, asked),
            pipeline.estimate_photographs([plate], network, film, asked).estimate,
        ):
            assert (found.prior, found.origins) == ("film only", ())
            assert found.families[Family.FILM] == pytest.approx(1)

    def test_metadata_counts_by_default(self, plate, network, prior, options):
        found = pipeline.estimate_frames(FrameSequence((plate,)), network, prior, options)
        assert found.prior == "camera"
        assert [origin.jpeg_quality for origin in found.origins] == [95]

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            (None, r"no prior \(.*\); give any, camera or a JSON file"),
            ("no JSON", "is not JSON"),
            ("{}", 'needed is {"shares"'),
            ('{"shares": {"fim": 1}, "evidence": 1}', "shares are of phone, compact"),
        ],
    )
    def test_a_bad_prior_is_told_in_one_line(self, tmp_path, text, message):
        path = tmp_path / "prior.json"
        if text is not None:
            path.write_text(text)
        with pytest.raises(PriorError, match=message) as told:
            pipeline.load_prior(EstimateOptions(prior=path))
        assert "\n" not in str(told.value)

    def test_the_lut_carries_its_provenance(self, plate, network, prior, options, true_response):
        found = pipeline.estimate_frames(FrameSequence((plate,)), network, prior, options)
        lut = pipeline.response_lut(found)
        assert len(lut.values) == LUT_LENGTH
        assert "Photographs: plate.jpg" in lut.comments
        codes = np.linspace(0, 1, LUT_LENGTH)
        np.testing.assert_allclose(lut.values, found.curve.inverse(codes), atol=1e-6)
        np.testing.assert_allclose(lut.values, true_response.inverse(codes), atol=0.1)


class TestExposure:
    def test_white_is_the_anchor_unless_a_gray_is_given(self):
        assert pipeline.anchored_exposure(ResponseCurve.gamma(2.2)) == 0
        assert pipeline.anchored_exposure(ResponseCurve.gamma(2.2), stops=1.5) == 1.5

    def test_a_gray_becomes_018(self):
        curve = ResponseCurve.gamma(2.2)
        stops = pipeline.anchored_exposure(curve, gray=0.5, stops=1)
        assert curve.inverse(0.5) * 2 ** (stops - 1) == pytest.approx(0.18)

    def test_the_gray_of_three_tables_is_that_of_green(self):
        red, green, blue = (inverse_response_lut(ResponseCurve.gamma(power), length=256) for power in (1.8, 2.2, 2.6))
        stops = pipeline.anchored_exposure(RgbLut1D((red, green, blue)), gray=0.5)
        assert float(green.apply(0.5)) * 2**stops == pytest.approx(0.18)

    def test_black_is_no_anchor(self):
        with pytest.raises(CRFNetError, match="a brightness of 0 is black in this response"):
            pipeline.anchored_exposure(ResponseCurve.gamma(2.2), gray=0.0)


def bake(sequence, targets, lut, options, *, progress=None):
    with pipeline.all_or_none(targets, overwrite=options.overwrite) as staged:
        linearize_plates(sequence, staged, lut, options, progress=progress)


class TestAllOrNone:
    def test_writes_every_frame_into_a_new_folder(self, sequence, tmp_path):
        calls = []
        targets = linear_targets(tmp_path / "new" / "deep" / "lin.%04d.exr", sequence)
        bake(sequence, targets, LUT, PlateOptions(), progress=lambda *call: calls.append(call))
        assert listed(tmp_path / "new" / "deep") == [f"lin.{number:04d}.exr" for number in range(1, 13)]
        assert calls[-1] == (12, 12)

    @pytest.mark.parametrize("done", [0, 3])
    def test_a_cancelled_run_leaves_nothing(self, sequence, tmp_path, done):
        targets = linear_targets(tmp_path / "new" / "lin.%04d.exr", sequence)
        with pytest.raises(CancelledError):
            bake(sequence, targets, LUT, PlateOptions(), progress=cancel_after(done))
        assert not (tmp_path / "new").exists()

    def test_a_cancelled_run_keeps_what_was_there_before(self, sequence, tmp_path):
        targets = linear_targets(tmp_path / "new" / "lin.%04d.exr", sequence)
        (tmp_path / "new").mkdir()
        for target in (targets[0], targets[5]):
            target.write_text("mine")
        with pytest.raises(CancelledError):
            bake(sequence, targets, LUT, PlateOptions(overwrite=True), progress=cancel_after(3))
        assert listed(tmp_path / "new") == ["lin.0001.exr", "lin.0006.exr"]
        assert [targets[0].read_text(), targets[5].read_text()] == ["mine", "mine"]

    def test_a_bad_frame_leaves_nothing(self, sequence, tmp_path):
        sequence.paths[4].write_bytes(b"no picture")
        targets = linear_targets(tmp_path / "new" / "lin.%04d.exr", sequence)
        with pytest.raises(PlateError, match="1 of 12 frames failed"):
            bake(sequence, targets, LUT, PlateOptions())
        assert not (tmp_path / "new").exists()

    @pytest.mark.parametrize("refused", ["pathlib.Path.mkdir", "tempfile.mkdtemp"])
    def test_a_folder_that_cannot_be_made_or_written_to_is_one_sentence(self, tmp_path, monkeypatch, refused):
        def refuse(*_arguments, **_options):
            raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr(refused, refuse)
        with pytest.raises(PlateError, match=r"new: cannot be written to \(No space left on device\); choose"):
            bake(FrameSequence(()), [tmp_path / "new" / "lin.exr"], LUT, PlateOptions())
        assert not (tmp_path / "new").exists()

    def test_a_folder_in_which_opencolorio_finds_no_lut_is_fine_for_linear_plates(self, plate, tmp_path):
        target = tmp_path / "projects$" / "lin.exr"
        bake(FrameSequence((plate,)), [target], LUT, PlateOptions())
        assert target.exists()

    def test_existing_files_are_refused_unless_asked(self, plate, tmp_path):
        single, target = FrameSequence((plate,)), tmp_path / "lin.exr"
        target.write_text("mine")
        with pytest.raises(CRFNetError, match="exists already"):
            bake(single, [target], LUT, PlateOptions())
        assert target.read_text() == "mine"
        bake(single, [target], LUT, PlateOptions(overwrite=True))
        assert target.stat().st_size > 1000


def test_a_worker_reads_a_prior_anew(fixed_model, tmp_path):
    path = tmp_path / "mine.json"
    shares = dict.fromkeys(Family, 0.125)
    path.write_text(json.dumps({"shares": shares, "evidence": 1.0}))
    options = EstimateOptions(model=fixed_model, prior=str(path))
    network, before = network_and_prior(options)
    path.write_text(json.dumps({"shares": shares, "evidence": 0.5}))
    again, after = network_and_prior(options)
    assert again is network
    assert (before.evidence, after.evidence) == (1.0, 0.5)


def test_only_the_response_of_a_task_is_read_from_files(plate, tmp_path):
    lut = tmp_path / "gone.spi1d"
    (task,) = pipeline.plan_each_linear(
        tmp_path / "out", {plate: Path()}, EstimateOptions(camera="gone"), PlateOptions(), lut
    )
    assert (task.settings["lut"], task.settings["camera"]) == (lut, "gone")
    with pytest.raises(CRFNetError, match=r"gone\.spi1d"):
        task.response_identity()

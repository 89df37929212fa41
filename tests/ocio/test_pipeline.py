"""The steps that command and add-on share: estimates, exposure, and files that are written together or not at all."""

import errno
import json
import sys
from pathlib import Path
from unittest.mock import Mock

import pytest

from crfnet import pipeline
from crfnet.cli.main import main
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.errors import PlateError
from crfnet.luts.lut1d import inverse_response_lut
from crfnet.luts.rgb_lut import RgbLut1D
from crfnet.options import EstimateOptions, OutputOptions, PlateOptions
from crfnet.output_files import OutputFiles
from crfnet.pipeline import estimates
from crfnet.plates.frames import FrameSequence
from crfnet.plates.light import PlateLight
from crfnet_core import AnalysisOptions, CRFNetError, ResponseCurve
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.posterior import Family
from tests.helpers.refusals import refused

LUT = inverse_response_lut(ResponseCurve.gamma(2.2))


class CancelledError(Exception):
    """What a program of its own raises in a progress callback."""


def cancel(done, total):
    if done:
        raise CancelledError


@pytest.fixture(scope="module")
def options(fixed_model):
    return EstimateOptions(model=fixed_model, analysis=AnalysisOptions(windows=2))


class TestEstimates:
    def test_a_batch_takes_texts_as_paths_and_refuses_other_kinds_before_it_begins(self, plate, options, tmp_path):
        outputs = OutputOptions(has_sheet=False, has_linear=False)
        batch = pipeline.EstimateBatch(out=f"{tmp_path}/out", options=options, plates=PlateOptions(), outputs=outputs)
        for facts in (
            {"workers": 0},
            {"workers": True},
            {"photographs": {plate: "../out2"}},
            {"photographs": {plate: 1}},
        ):
            with refused(CRFNetError, "bad_option", name=next(iter(facts))):
                pipeline.run_batch(batch, **{"photographs": {plate: ""}, **facts})
        assert not (tmp_path / "out").exists()
        found = pipeline.find_photographs(str(plate), batch.out)
        assert [record.error for record in pipeline.run_batch(batch, found, workers=1)] == [""]

    def test_the_facts_of_a_photograph_outlive_its_pixels(self, plate, options):
        found = pipeline.estimate_files(iter([FrameSequence((plate,))] * 2), options)
        assert [str(facts.entry) for facts in found.photographs] == ["plate.jpg: 672 x 378, 8 bits"] * 2
        assert (found.photographs[0].preview.shape, found.photographs[0].stride) == ((378, 672, 3), 1)
        assert found.photographs[1].preview.size == 0

    def test_what_the_callback_raises_ends_the_estimate(self, plate, options):
        with pytest.raises(CancelledError):
            pipeline.estimate_files([FrameSequence((plate,))], options, progress=cancel)


def test_the_gray_of_three_tables_is_that_of_green():
    red, green, blue = (inverse_response_lut(ResponseCurve.gamma(power), length=256) for power in (1.8, 2.2, 2.6))
    stops = pipeline.anchored_exposure(RgbLut1D((red, green, blue)), gray=0.5)
    assert float(green.apply(0.5)) * 2**stops == pytest.approx(0.18)


def light_of(lut, **options):
    return PlateLight.from_tags(ColorTags(), lut, PlateOptions(**options))


class TestExport:
    @pytest.fixture
    def plan(self, tmp_path):
        return self.planned(tmp_path / "look")

    def planned(self, folder, *, overwrite=False):
        files = OutputFiles.named(folder, [Path("plate.png")], OutputOptions(has_sheet=False, has_linear=False))
        space = PlateColorSpace.from_outputs(files, Path("plate.png"), file_pattern="plate.*.png")
        return pipeline.OutputPlan(files, PlateOptions(overwrite=overwrite), space)

    def test_a_failure_in_the_middle_leaves_earlier_files_as_they_were(self, plan, tmp_path, monkeypatch):
        pipeline.deliver(plan, light_of(LUT))
        earlier = {path: path.read_bytes() for path in plan.targets}
        monkeypatch.setattr("crfnet.pipeline.delivery.write_config", lambda *arguments, **options: 1 / 0)
        other = inverse_response_lut(ResponseCurve.gamma(1.5))
        with pytest.raises(ZeroDivisionError):
            pipeline.deliver(self.planned(tmp_path / "look", overwrite=True), light_of(other))
        assert {path: path.read_bytes() for path in plan.files.config.parent.iterdir()} == earlier

    def test_a_folder_in_which_opencolorio_finds_no_lut_is_refused(self, tmp_path):
        with refused(PlateError, "variables_in_path"):
            pipeline.deliver(self.planned(tmp_path / "projects$"), light_of(LUT))
        assert not (tmp_path / "projects$").exists()

    @pytest.mark.parametrize("step", ["pathlib.Path.mkdir", "tempfile.mkdtemp"])
    def test_a_folder_that_cannot_be_made_or_written_to_is_refused(self, plan, tmp_path, monkeypatch, step):
        monkeypatch.setattr(step, Mock(side_effect=OSError(errno.ENOSPC, "No space left on device")))
        with refused(PlateError, "folder_not_written", path=tmp_path / "look", reason="No space left on device"):
            pipeline.deliver(plan, light_of(LUT))
        assert not (tmp_path / "look").exists()

    @pytest.mark.parametrize("problem", [PlateError("disk full"), KeyboardInterrupt(), CancelledError()])
    def test_a_failure_in_the_middle_leaves_nothing(self, plan, monkeypatch, problem):
        monkeypatch.setattr("crfnet.pipeline.delivery.write_config", Mock(side_effect=problem))
        with pytest.raises(type(problem)):
            pipeline.deliver(plan, light_of(LUT))
        assert not plan.files.config.parent.exists()


def test_a_process_reads_a_prior_anew_and_a_network_once(plate, fixed_model, tmp_path):
    path = tmp_path / "mine.json"
    options = EstimateOptions(model=fixed_model, prior=str(path), analysis=AnalysisOptions(windows=2))
    found = []
    for evidence in (1.0, 0.5):
        path.write_text(json.dumps({"shares": dict.fromkeys(Family, 0.125), "evidence": evidence}))
        found.append(pipeline.estimate_files([FrameSequence((plate,))], options).estimate.families)
    assert found[0] != found[1]
    assert estimates.load_network(fixed_model, 0) is estimates.load_network(fixed_model, 0)


def test_the_estimate_is_near_the_command(plate, fixed_model, tmp_path, monkeypatch):
    """A reader who starts at `main` reaches the method in six functions of ours."""
    frames = []
    estimate_response = estimates.estimate_response

    def count(*arguments, **options):
        frame = sys._getframe(1)
        while frame:
            frames.append(frame.f_code.co_name)
            if frame.f_code is main.__code__:
                break
            frame = frame.f_back
        return estimate_response(*arguments, **options)

    monkeypatch.setattr(estimates, "estimate_response", count)
    arguments = ["estimate", plate, "--out", tmp_path / "out", "--model", fixed_model, "--no-sheet", "--no-linear"]
    assert main(list(map(str, arguments))) == 0
    assert ["estimate_response", *frames][-1] == "main"
    assert len(["estimate_response", *frames]) <= 6

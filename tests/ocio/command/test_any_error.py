"""One bad file stops no other, whatever its reader raises."""

from pathlib import Path

import pytest

from crfnet.movies import source
from crfnet.options import EstimateOptions, OutputOptions, PlateOptions
from crfnet.pipeline import find_photographs, run_batch
from crfnet.pipeline.each import EstimateBatch
from crfnet.plates import frames as plate_frames
from tests.helpers.records import records_in


class TextlessError(Exception):
    """An error whose text cannot be had, and which cannot be sent to another process."""

    def __init__(self, *, needed=None):
        super().__init__(lambda: needed)

    def __str__(self):
        raise ZeroDivisionError


ERRORS = (
    TextlessError(),
    MemoryError(),
    OSError(5, "Input/output error"),
    KeyError("\x1b[31m"),
    SystemExit(0),
    GeneratorExit(),
)


def failing(read, problem):
    """Read a file with `read`, but raise `problem` for those whose name has "bad" or a 2."""

    def fail(path, *arguments, **options):
        if "bad" in Path(path).name or "2" in Path(path).name:
            raise problem
        return read(path, *arguments, **options)

    return fail


def assert_only_bad_failed(folder, photographs):
    """The photograph "bad.jpg" has an error in its record, which names it; the others have none."""
    (error,) = [record["error"] for record in records_in(folder) if record["error"]]
    assert error.startswith(f"{photographs / 'bad.jpg'}: ")


@pytest.mark.parametrize("problem", ERRORS, ids=lambda problem: type(problem).__name__)
def test_it_is_the_error_of_that_photograph_or_frame(
    estimate, crfnet, photographs, frames, look, tmp_path, monkeypatch, problem
):
    (photographs / "bad.jpg").write_bytes((photographs / "a.jpg").read_bytes())
    monkeypatch.setattr(source, "read_photo", failing(source.read_photo, problem))
    monkeypatch.setattr(plate_frames, "read_frame", failing(plate_frames.read_frame, problem))
    arguments = ("--each", "--no-linear", "--workers", "1")
    assert estimate(photographs / "bad.jpg", photographs / "a.jpg", *arguments).refusal == "photographs_failed"
    assert_only_bad_failed(tmp_path / "out", photographs)
    lut = ("--lut", look / "plate.spi1d", "--workers", "1")
    done = crfnet("linearize", photographs, "--each", "--out", tmp_path / "linear", *lut)
    assert done.refusal == "photographs_failed"
    assert_only_bad_failed(tmp_path / "linear", photographs)
    done = crfnet("linearize", frames / "shot.####.jpg", *lut[:2], "--out", frames / "a.####.exr")
    assert (done.refusal, "shot.0002.jpg" in done.err) == ("frames_failed", True)
    assert sorted(path.name for path in frames.glob("*.exr")) == ["a.0001.exr", "a.0003.exr", "a.0005.exr"]


def test_an_interruption_stops_them_all(estimate, crfnet, photographs, frames, look, out, monkeypatch):
    (photographs / "bad.jpg").write_bytes((photographs / "a.jpg").read_bytes())
    monkeypatch.setattr(source, "read_photo", failing(source.read_photo, KeyboardInterrupt()))
    monkeypatch.setattr(plate_frames, "read_frame", failing(plate_frames.read_frame, KeyboardInterrupt()))
    done = estimate(photographs, "--each", "--no-linear", "--workers", "1")
    assert (done.code, done.err) == (130, "crfnet: interrupted\n")
    done = crfnet("linearize", frames / "shot.####.jpg", "--lut", look / "plate.spi1d", "--out", out / "a.####.exr")
    assert (done.code, done.err) == (130, "crfnet: interrupted\n")


class FailingBatch(EstimateBatch):
    """A batch whose photograph "bad.jpg" raises an error that no process can send."""

    def done(self, task):
        if task.photo.name == "bad.jpg":
            raise TextlessError
        return super().done(task)


def test_it_is_the_error_of_that_photograph_in_a_process(photographs, fixed_model, tmp_path):
    (photographs / "bad.jpg").write_bytes(b"")
    outputs = OutputOptions(has_linear=False, has_sheet=False)
    options = EstimateOptions(model=fixed_model)
    batch = FailingBatch(out=tmp_path / "out", options=options, plates=PlateOptions(), outputs=outputs)
    found = find_photographs([photographs / "bad.jpg", photographs / "a.jpg"], tmp_path / "out")
    run_batch(batch, found, workers=2)
    assert_only_bad_failed(tmp_path / "out", photographs)

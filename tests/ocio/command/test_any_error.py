"""One bad file stops no other, whatever its reader raises."""

import json
from pathlib import Path

import pytest

from crfnet.cli.arguments.parts import BAD_INPUT
from crfnet.defaults import ESTIMATES, PLATES
from crfnet.movies import source
from crfnet.options import EstimateOptions, OutputOptions, PlateOptions
from crfnet.pipeline import find_photographs, run_batch
from crfnet.pipeline.each import EstimateBatch
from crfnet.plates import frames as plate_frames
from tests.helpers.folders import listed


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
    UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid"),
    RecursionError("deep"),
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


def error_of(file, name):
    """The error in the record of a photograph; the others have none."""
    errors = {
        Path(entry["photograph"]).name: entry["error"] for entry in map(json.loads, file.read_text().splitlines())
    }
    assert [key for key, error in errors.items() if error] == [name]
    return errors[name]


@pytest.mark.parametrize("problem", ERRORS, ids=lambda problem: type(problem).__name__)
def test_it_is_the_error_of_that_photograph_or_frame(
    estimate, crfnet, photographs, look, tmp_path, monkeypatch, problem
):
    (photographs / "bad.jpg").write_bytes((photographs / "a.jpg").read_bytes())
    monkeypatch.setattr(source, "read_photo", failing(source.read_photo, problem))
    monkeypatch.setattr(plate_frames, "read_frame", failing(plate_frames.read_frame, problem))
    done = estimate(photographs, "--each", "--no-linear", "--workers", "1")
    assert (done.code, done.err.count("\n")) == (BAD_INPUT, 1)
    assert f"{photographs / 'bad.jpg'}: " in error_of(tmp_path / "out" / ESTIMATES, "bad.jpg")
    lut = ("--lut", look / "plate.spi1d", "--workers", "1")
    done = crfnet("linearize", photographs, "--each", "--out", tmp_path / "linear", *lut)
    assert (done.code, done.err.count("\n")) == (BAD_INPUT, 1)
    assert f"{photographs / 'bad.jpg'}: " in error_of(tmp_path / "linear" / PLATES, "bad.jpg")


@pytest.mark.parametrize("problem", ERRORS, ids=lambda problem: type(problem).__name__)
@pytest.mark.parametrize("bad", [1, 2])
def test_it_is_the_error_of_that_frame(crfnet, frames, look, out, monkeypatch, problem, bad):
    (frames / f"shot.000{bad}.jpg").rename(frames / "shot.0022.jpg")
    monkeypatch.setattr(plate_frames, "read_frame", failing(plate_frames.read_frame, problem))
    done = crfnet("linearize", frames / "shot.####.jpg", "--lut", look / "plate.spi1d", "--out", out / "a.####.exr")
    assert (done.code, done.err.count("\n")) == (BAD_INPUT, 1)
    assert "shot.00" in done.err
    assert {"a.0003.exr", "a.0005.exr"} <= set(listed(out))


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
    records = run_batch(batch, find_photographs([photographs], tmp_path / "out"), workers=2)
    errors = {Path(record.photograph).name: record.error for record in records}
    assert errors.pop("bad.jpg").startswith(f"{photographs / 'bad.jpg'}: ")
    assert set(errors.values()) == {""}

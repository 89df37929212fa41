"""What the commands of `crfnet` do; `ocio.cli` holds their arguments."""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import PyOpenColorIO as OCIO
from numpy.typing import NDArray
from tqdm import tqdm

from crfnet_core.errors import ModelError, PlateError
from crfnet_core.estimate import ResponseEstimate, estimate_response
from crfnet_core.files import atomic_write_text
from crfnet_core.image_io import read_photo
from crfnet_core.network import ResponseNetwork, model_folder
from crfnet_core.photo import Photo
from ocio import report as describe
from ocio.configs.plate_color_space import write_config
from ocio.configs.portable import portable_config
from ocio.luts.files import READERS, read_lut, write_lut
from ocio.luts.lut1d import DEFAULT_LENGTH, Lut1D, inverse_response_lut
from ocio.output_files import OutputFiles, check_folder, check_outputs, output_folder
from ocio.plates.frames import FrameSequence, find_frames, sample_frames
from ocio.plates.linear import linearize_plates

#: Frames of a sequence from which its one response is estimated.
FRAMES_ANALYSED = 8

#: Either part of a model stands for its folder.
MODEL_FILES = ("model.json", "model.onnx")

#: Longer side in pixels of the photograph as the sheet shows it.
PREVIEW_SIDE = 960

NO_MATPLOTLIB = "crfnet: no sheet is drawn, matplotlib is absent: pip install 'crfnet[plot]', or add --no-sheet"

Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class Finding:
    """An estimate, and what its files still need of the photographs once their pixels are gone."""

    paths: tuple[Path, ...]
    facts: tuple[describe.PhotoFacts, ...]
    preview: NDArray[np.float32]
    stride: int
    estimate: ResponseEstimate
    files: OutputFiles


def run_estimate(options: argparse.Namespace) -> None:
    """Estimate one response of all photographs, or one of each; write every file; say what was found."""
    groups = [(photo,) for photo in options.photos] if options.each else [tuple(options.photos)]
    has_sheet = not options.no_sheet and _has_matplotlib()
    outputs = [OutputFiles.named(options.out, group, has_sheet=has_sheet) for group in groups]
    check_outputs(options.out, outputs, photos=options.photos, overwrite=options.overwrite)
    spaces = [files.plate_color_space(group[0], options.exposure) for group, files in zip(groups, outputs, strict=True)]
    config = portable_config(spaces)
    network = ResponseNetwork.load(options.model, threads=options.threads)
    findings = [_find(group, files, network, options) for group, files in zip(groups, outputs, strict=True)]
    with output_folder(options.out):
        documents = _write_findings(findings, config, options)
    if options.json:
        _print_json({"folder": str(options.out), "estimates": documents})
    else:
        _print_findings(findings, options.out)


def run_linearize(options: argparse.Namespace) -> None:
    """Write plates as linear EXR through a LUT, or through a response estimated from several of the frames."""
    sequence = find_frames(options.plates, options.frames)
    folder = Path(options.out).parent
    check_folder(folder)
    estimate = None if options.lut else _estimate_frames(sequence, options)
    lut = _lut(estimate) if estimate else read_lut(options.lut)
    with output_folder(folder), _progress_bar("frames") as progress:
        report = linearize_plates(
            options.plates,
            options.out,
            lut,
            frames=options.frames,
            depth=options.depth,
            exposure=options.exposure,
            overwrite=options.overwrite,
            progress=progress,
        )
    if options.json:
        _print_json(describe.plate_document(report, estimate))
    else:
        found = [describe.source_line(estimate), *describe.verdict_lines(estimate)] if estimate else []
        _print_lines([*found, *describe.plate_lines(report)])


def run_info(options: argparse.Namespace) -> None:
    """Say what a LUT file or a model folder holds."""
    subject: Path = options.subject
    if subject.suffix.lower() in READERS:
        document = describe.lut_document(subject, read_lut(subject))
        lines = describe.lut_lines(document)
    elif (folder := model_folder(subject.parent if subject.name in MODEL_FILES else subject)).is_dir():
        document = describe.model_document(ResponseNetwork.load(folder).config)
        lines = describe.model_lines(document)
    else:
        raise ModelError(f"{subject}: is neither a LUT ({', '.join(READERS)}) nor a model folder; give one of these")
    if options.json:
        _print_json(document)
    else:
        _print_lines(lines)


def _find(paths: Sequence[Path], files: OutputFiles, network: ResponseNetwork, options: argparse.Namespace) -> Finding:
    """Read photographs one by one and estimate their response; keeps no more than a preview of the first."""
    facts: list[describe.PhotoFacts] = []
    previews: list[NDArray[np.float32]] = []

    def photos() -> Iterator[Photo]:
        for path in paths:
            photo = read_photo(path)
            facts.append(_facts(photo))
            if not previews:
                stride = _stride(facts[0])
                previews.append(photo.pixels[::stride, ::stride].copy())
            yield photo

    with _progress_bar("windows") as progress:
        estimate = estimate_response(
            photos(), network=network, windows=options.windows, seed=options.seed, progress=progress
        )
    return Finding(tuple(paths), tuple(facts), previews[0], _stride(facts[0]), estimate, files)


def _stride(facts: describe.PhotoFacts) -> int:
    """Return how many pixels apart the samples of a photograph's preview lie."""
    return max(1, -(-max(facts.width, facts.height) // PREVIEW_SIDE))


def _facts(photo: Photo) -> describe.PhotoFacts:
    """Return what the report says of a photograph."""
    height, width = photo.pixels.shape[:2]
    return describe.PhotoFacts(photo.path.name, width, height, photo.bit_depth)


def _estimate_frames(sequence: FrameSequence, options: argparse.Namespace) -> ResponseEstimate:
    """Return the one response of a sequence, from up to `FRAMES_ANALYSED` of its frames, evenly spread."""
    network = ResponseNetwork.load(options.model, threads=options.threads)
    photos = map(read_photo, sample_frames(sequence, FRAMES_ANALYSED))
    with _progress_bar("windows") as progress:
        return estimate_response(photos, network=network, progress=progress)


def _lut(estimate: ResponseEstimate, length: int = DEFAULT_LENGTH) -> Lut1D:
    """Return the inverse of an estimated response with its provenance."""
    return inverse_response_lut(estimate.curve, length=length, comments=describe.provenance(estimate))


def _write_findings(
    findings: Sequence[Finding], config: OCIO.Config, options: argparse.Namespace
) -> list[dict[str, Any]]:
    """Write everything into the output folder and return the estimates' documents."""
    luts = {}
    documents = []
    for finding in findings:
        lut = _write_luts(finding, options)
        luts[finding.files.color_space] = lut
        _write_linear(finding, lut, options)
        if finding.files.sheet:
            _write_sheet(finding, finding.files.sheet, overwrite=options.overwrite)
        documents.append(describe.estimate_document(finding.estimate, finding.facts, finding.files))
        _write_json(finding.files.report, documents[-1], overwrite=options.overwrite)
    write_config(findings[0].files.config, config, check=luts, overwrite=options.overwrite)
    return documents


def _write_luts(finding: Finding, options: argparse.Namespace) -> Lut1D:
    """Write the inverse response in three formats and return it."""
    lut = _lut(finding.estimate, options.length)
    for path in (finding.files.spi1d, finding.files.cube, finding.files.clf):
        write_lut(path, lut, overwrite=options.overwrite)
    return lut


def _write_linear(finding: Finding, lut: Lut1D, options: argparse.Namespace) -> None:
    """Write the linear EXR of every photograph."""
    for photo, linear in zip(finding.paths, finding.files.linear, strict=True):
        linearize_plates(
            photo, linear, lut, depth=options.depth, exposure=options.exposure, overwrite=options.overwrite
        )


def _has_matplotlib() -> bool:
    """Return whether a sheet can be drawn, and say on stderr how to get there if not."""
    if find_spec("matplotlib") is not None:
        return True
    print(NO_MATPLOTLIB, file=sys.stderr)  # noqa: T201
    return False


def _write_sheet(finding: Finding, path: Path, *, overwrite: bool) -> None:
    """Draw the sheet; matplotlib is an extra and takes its time to load, so it is loaded here."""
    from ocio.sheet import draw_sheet

    draw_sheet(path, finding.preview, finding.estimate, stride=finding.stride, overwrite=overwrite)


def _write_json(path: Path, document: dict[str, Any], *, overwrite: bool) -> None:
    """Write a JSON document."""
    atomic_write_text(path, _json(document), overwrite=overwrite, error=PlateError)


def _json(document: dict[str, Any]) -> str:
    """Return a document as JSON text, any language as it is written and each row of numbers on one line."""
    text = json.dumps(document, indent=1, ensure_ascii=False)
    return re.sub(r"\[\n[-+\d.eE,\s]+\]", lambda row: " ".join(row[0].split()), text) + "\n"


def _print_findings(findings: Sequence[Finding], folder: Path) -> None:
    """Print what was read, found and written, and how to use it; of several estimates, a line each."""
    first, *others = findings
    if others:
        _print_lines([*(describe.result_line(finding.estimate) for finding in findings), ""])
        _print_lines([f"Written to {folder}, for each photograph as for the first:"])
    else:
        _print_lines([*map(str, first.facts), *describe.verdict_lines(first.estimate), "", f"Written to {folder}:"])
    _print_lines([*describe.file_lines(first.files), "", "The linear plate in oiiotool, with the LUT or the config:"])
    _print_lines(f"  {line}" for line in describe.oiiotool_lines(first.paths[0], first.files))


def _print_json(document: dict[str, Any]) -> None:
    """Print a JSON document."""
    sys.stdout.write(_json(document))


def _print_lines(lines: Iterable[str]) -> None:
    """Print lines."""
    sys.stdout.writelines(f"{line}\n" for line in lines)


@contextmanager
def _progress_bar(unit: str) -> Iterator[Progress | None]:
    """Yield a callback that moves a bar on stderr, or None where stderr is no terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    with tqdm(unit=f" {unit}", leave=False, file=sys.stderr) as bar:

        def show(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        yield show

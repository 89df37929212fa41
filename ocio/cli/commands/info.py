"""`crfnet info`: what a LUT file, another file of a response, or a model folder holds."""

from __future__ import annotations

import argparse
from pathlib import Path

from crfnet_core.errors import ModelError
from crfnet_core.network import ResponseNetwork, model_folder

from ... import report
from ...interchange.files import READABLE, read_response
from ...luts.files import READERS, read_lut
from .printing import print_json, print_lines

#: Names of the files of a model; either of them stands for its folder.
MODEL_FILES = ("model.json", "model.onnx")


def run(arguments: argparse.Namespace) -> None:
    """Say what a LUT file or a model folder holds."""
    subject: Path = arguments.subject
    if (suffix := subject.suffix.lower()) in READABLE:
        found = read_response(subject)
        lut = read_lut(subject) if suffix in READERS else found.lut
        document = report.lut_document(subject, lut, found)
        lines = report.lut_lines(document)
    elif (folder := model_folder(subject.parent if subject.name in MODEL_FILES else subject)).is_dir():
        document = report.model_document(ResponseNetwork.load(folder).config)
        lines = report.model_lines(document)
    else:
        raise ModelError(
            f"{subject}: is neither a response ({', '.join(READABLE)}) nor a model folder; give one of these"
        )
    if arguments.json:
        print_json(document)
    else:
        print_lines(lines)

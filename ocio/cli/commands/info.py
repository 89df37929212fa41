"""`crfnet info`: the contents of a LUT file or a model folder."""

from __future__ import annotations

import argparse
from pathlib import Path

from crfnet_core.network import ResponseNetwork, model_folder

from ... import report
from ...luts.opencolorio import READABLE
from ...luts.response import read_response
from ..remedies import CommandError
from .printing import print_result

#: Names of the files of a model; either of them stands for its folder.
MODEL_FILES = ("model.json", "model.onnx")


def run(arguments: argparse.Namespace) -> None:
    """Print the contents of a LUT file or a model folder."""
    subject: Path = arguments.subject
    if subject.suffix.lower() in READABLE:
        document = report.lut_document(read_response(subject))
        lines = report.lut_lines(document)
    elif (folder := model_folder(subject.parent if subject.name in MODEL_FILES else subject)).is_dir():
        document = report.model_document(ResponseNetwork.load(folder).config)
        lines = report.model_lines(document)
    else:
        raise CommandError("neither_lut_nor_model", path=subject, suffixes=", ".join(READABLE))
    print_result(document, lines, as_json=arguments.json)

"""`crfnet info`: the contents of a LUT file."""

import argparse

from ...luts.response import read_response
from ...report.documents import lut_document
from ...report.words import lut_lines
from .printing import print_result


def run(arguments: argparse.Namespace) -> None:
    """Print the contents of a LUT file."""
    document = lut_document(read_response(arguments.lut))
    print_result(document, lut_lines(document), as_json=arguments.json)

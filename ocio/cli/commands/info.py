"""`crfnet info`: the contents of a LUT file."""

import argparse

from ... import report
from ...luts.response import read_response
from .printing import print_result


def run(arguments: argparse.Namespace) -> None:
    """Print the contents of a LUT file."""
    document = report.lut_document(read_response(arguments.lut))
    print_result(document, report.lut_lines(document), as_json=arguments.json)

"""`crfnet convert`: its arguments."""

from __future__ import annotations

from pathlib import Path

from .parts import Commands, add_command, add_json, written_path

EXAMPLES = """examples:
  crfnet convert look/plate01.spi1d response.npy               for OpenCV's createMergeDebevec
  crfnet convert response.m camera.cube                        from pfshdrcalibrate to a LUT
  crfnet convert dorfCurves.txt one.spi1d --curve Agfacolor-futura100CD
  crfnet convert look/plate01.spi1d pano.pto --overwrite       sets Ra to Re of all images of a Hugin project
  crfnet convert look/plate01.spi1d look.cube --forward        simulate the camera: light in, code values out

read:    .spi1d .cube .clf .csp .3dl .lut; Hugin .pto; DoRF .txt; pfstools .m; OpenCV .npy .yml .yaml .xml
written: .spi1d .cube .clf; Hugin .pto; DoRF .txt; pfstools .m; OpenCV .npy .yml .yaml .xml"""


def add(commands: Commands) -> None:
    """Add `crfnet convert`."""
    parser = add_command(commands, "convert", "convert a camera response between LUTs and other programs", EXAMPLES)
    parser.add_argument("source", type=Path, metavar="SOURCE", help="the response or its inverse; see below")
    parser.add_argument("out", type=written_path, metavar="OUT", help="file to be written; its suffix names the format")
    parser.add_argument("--curve", default="", metavar="NAME", help="of several curves (DoRF) or images (Hugin)")
    parser.add_argument("--forward", action="store_true", help="write the LUT from light to code values instead")
    parser.add_argument("--overwrite", action="store_true", help="replace, or change in place, what is already there")
    add_json(parser)

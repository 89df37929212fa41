"""`crfnet linearize`: its arguments."""

from __future__ import annotations

from pathlib import Path

from .parts import Commands, add_command, add_frames, add_network, add_plate, written_path

EXAMPLES = """examples:
  crfnet linearize plate01.jpg --lut look/plate01.spi1d --out plate01_linear.exr
  crfnet linearize shot.%04d.png --lut look/plate01.spi1d --out linear/shot.%04d.exr
  crfnet linearize shot.%04d.png --camera "A7 III" --out linear/shot.%04d.exr
  crfnet linearize 'shot.####.jpg' --frames 1001-1100 --out 'linear/shot.####.exr'
  crfnet linearize clip.mov --frames 1-100 --lut look/clip.spi1d --out linear/clip.%04d.exr
  crfnet linearize photographs/ --each --camera "A7 III" --out linear       a whole folder; can be continued

Without --lut and --camera one response is estimated from several of the frames. Frames that are already written are
left alone, so an interrupted run goes on where it stopped. The first frame of a movie has number 1."""


def add(commands: Commands) -> None:
    """Add `crfnet linearize`."""
    parser = add_command(commands, "linearize", "write a plate or a frame sequence as linear EXR", EXAMPLES)
    parser.add_argument(
        "plates",
        nargs="+",
        metavar="PLATES",
        help="a file, a movie, a folder of one sequence, or a sequence: shot.%%04d.png, shot.####.png;"
        " with --each photographs and folders of them",
    )
    parser.add_argument(
        "--out",
        type=written_path,
        required=True,
        metavar="PATTERN",
        help="file, or pattern like PLATES; with --each a folder",
    )
    parser.add_argument(
        "--lut", type=Path, metavar="FILE", help="the response: a 1D LUT of any format that OpenColorIO reads"
    )
    add_frames(parser, "photographs, not a sequence: without --lut and --camera each by its own response")
    parser.add_argument(
        "--encoded", action="store_true", help="OpenEXR plates that do not say it hold encoded values, not linear ones"
    )
    add_network(parser)
    add_plate(parser)

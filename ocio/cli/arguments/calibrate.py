"""`crfnet calibrate`: its arguments."""

from __future__ import annotations

from pathlib import Path

from .parts import Commands, add_command, add_json, written_path

EXAMPLES = """examples:
  crfnet calibrate stack/*.jpg --out camera --name eos20d
  crfnet calibrate a.jpg b.jpg c.jpg d.jpg --times 1/60,1/30,1/15,1/8 --out camera
  crfnet calibrate stack/*.jpg --out camera --compare look/plate01.json       how good was that estimate?
  crfnet calibrate SHOT.NEF --out camera --name d90           one raw file, with the JPEG beside it or inside it
  crfnet calibrate raw/ --out camera --name d90               all raw files of a folder, each with its JPEG

A stack is one still scene, from a tripod, in 4 or more frames a stop or so apart: the darkest shows nearly nothing
white, the brightest is mostly white. Fix ISO, aperture, white balance and the picture style; switch off automatic
tones. For eos20d the folder then holds eos20d.spi1d and other LUTs of the inverse response, config.ocio,
eos20d_sheet.png (every frame's points on the curve) and eos20d.json.

A raw file and the JPEG that the camera made of the same shot show the response at once; several shots of one picture
style are measured together. It needs rawpy and SciPy: pip install 'crfnet[calibrate]'."""


def add(commands: Commands) -> None:
    """Add `crfnet calibrate`."""
    parser = add_command(
        commands,
        "calibrate",
        "measure a camera's response from an exposure stack, or from raw files and their JPEGs",
        EXAMPLES,
    )
    parser.add_argument(
        "photos",
        nargs="+",
        type=Path,
        metavar="FILE",
        help="frames of a stack; or raw files, their JPEGs, folders of both",
    )
    parser.add_argument("--out", type=written_path, required=True, metavar="DIR", help="folder for everything written")
    parser.add_argument("--name", metavar="NAME", help="the name of the files and of the color space (first file's)")
    parser.add_argument(
        "--times", metavar="LIST", help="exposure times in seconds, one for each frame, instead of EXIF's"
    )
    parser.add_argument(
        "--compare", type=Path, metavar="FILE", help="a response to check: JSON of an estimate, or a LUT"
    )
    parser.add_argument(
        "--accept-edited", action="store_true", help="measure what a program makes of its files, not the camera"
    )
    parser.add_argument("--no-sheet", action="store_true", help="do not draw the picture")
    parser.add_argument("--overwrite", action="store_true", help="replace files that are already there")
    add_json(parser)

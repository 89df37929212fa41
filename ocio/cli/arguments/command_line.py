"""The whole command line of `crfnet`; `parts` has the options that subcommands share."""

import argparse
import sys
from pathlib import Path

from .parts import Commands, Parser, add_action, add_command, add_frames, add_json, add_network, add_plate, written_path

ESTIMATE_EXAMPLES = """examples:
  crfnet estimate plate01.jpg --out look
  crfnet estimate day1/*.jpg --out look            several photographs of one camera, one response
  crfnet estimate cam_a.jpg cam_b.jpg --each --out look        one response each
  crfnet estimate photographs/ --each --no-sheet --no-linear --out responses        a whole folder; can be continued
  crfnet estimate clip.mp4 --out look               a movie: some of its frames, one response
  crfnet estimate shot.%04d.dpx --frames 1001-1100 --out look        a sequence: some of these frames
  crfnet estimate scan.tif --out look --prior any              film scans, old video: not only today's cameras
  crfnet estimate plate01.jpg --out look --camera "A7 III"       the response of a stored camera: see crfnet camera

For plate01.jpg the folder then holds plate01.spi1d and other LUTs of the inverse response, config.ocio,
plate01_linear.exr, plate01_sheet.png (the estimate as a picture) and plate01.json."""

CALIBRATE_EXAMPLES = """examples:
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

LINEARIZE_EXAMPLES = """examples:
  crfnet linearize plate01.jpg --lut look/plate01.spi1d --out plate01_linear.exr
  crfnet linearize shot.%04d.png --lut look/plate01.spi1d --out linear/shot.%04d.exr
  crfnet linearize shot.%04d.png --camera "A7 III" --out linear/shot.%04d.exr
  crfnet linearize 'shot.####.jpg' --frames 1001-1100 --out 'linear/shot.####.exr'
  crfnet linearize clip.mov --frames 1-100 --lut look/clip.spi1d --out linear/clip.%04d.exr
  crfnet linearize photographs/ --each --camera "A7 III" --out linear       a whole folder; can be continued

Without --lut and --camera one response is estimated from several of the frames. Frames that are already written are
left alone, so an interrupted run goes on where it stopped. The first frame of a movie has number 1."""

CAMERA_EXAMPLES = """examples:
  crfnet camera add --from-calibration camera/a7.json --name "A7 III"    measured by crfnet calibrate
  crfnet camera list
  crfnet camera show "A7 III"                                  how good the response is
  crfnet camera export "A7 III" a7.spi1d                       or .cube, .clf, or .json to hand it on
  crfnet camera remove "A7 III"
  crfnet estimate plate.jpg --camera "A7 III" --out look

One name is for one picture mode: a camera set to another has another response. The library is a folder of JSON files
among the user's data, or in $CRFNET_DATA_DIR."""

CONFIG_EXAMPLES = """examples:
  crfnet config add --base /studio/config.ocio --out show look
  crfnet config add --base ocio://studio-config-v2.2.0_aces-v1.3_ocio-v2.4 --out show look night/plate02.json
  crfnet config add --base '$OCIO' --out show look/plate01.spi1d
  crfnet config list show

LOOK is the result of crfnet estimate: its folder, its JSON or a LUT. CONFIG is a file, the name of a config that is
built into OpenColorIO, $OCIO, or the folder or executable of a Blender. It stays as it is: the new config in FOLDER has
everything of it, finds its LUTs where they lie, and knows the plates, too."""

INFO_EXAMPLES = """examples:
  crfnet info look/plate01.spi1d"""


class _Version(argparse.Action):
    """Print the version, which takes half as long to look up as everything else takes to start."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        sys.stdout.write(f"{parser.prog} {version('crfnet')}\n")
        parser.exit()


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    parser = Parser(
        prog="crfnet",
        description="Camera response from one photograph: LUTs, an OpenColorIO config and a linear plate.",
        epilog="crfnet COMMAND --help shows examples.",
    )
    parser.add_argument(
        "--version", action=_Version, nargs=0, default=argparse.SUPPRESS, help="show program's version number and exit"
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for add in (_add_estimate, _add_calibrate, _add_camera, _add_linearize, _add_config, _add_info):
        add(commands)
    return parser


def _add_estimate(commands: Commands) -> None:
    """Add `crfnet estimate`."""
    parser = add_command(
        commands, "estimate", "estimate the response of the camera that took a photograph", ESTIMATE_EXAMPLES
    )
    parser.add_argument(
        "photos",
        nargs="+",
        type=Path,
        metavar="PHOTO",
        help="JPEG, HEIC, PNG, TIFF, DPX and others, a movie, or a sequence",
    )
    parser.add_argument("--out", type=written_path, required=True, metavar="DIR", help="folder for everything written")
    add_frames(parser, "one response per photograph, not one for all; PHOTO may be a folder")
    parser.add_argument("--forward", action="store_true", help="write the LUT from light to code values, too")
    parser.add_argument("--no-sheet", action="store_true", help="do not draw the picture")
    parser.add_argument("--no-linear", action="store_true", help="do not write the photographs as linear EXR")
    add_network(parser)
    add_plate(parser)


def _add_calibrate(commands: Commands) -> None:
    """Add `crfnet calibrate`."""
    parser = add_command(
        commands,
        "calibrate",
        "measure a camera's response from an exposure stack, or from raw files and their JPEGs",
        CALIBRATE_EXAMPLES,
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


def _add_linearize(commands: Commands) -> None:
    """Add `crfnet linearize`."""
    parser = add_command(commands, "linearize", "write a plate or a frame sequence as linear EXR", LINEARIZE_EXAMPLES)
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


def _add_camera(commands: Commands) -> None:
    """Add `crfnet camera` and its five actions."""
    parser = add_command(commands, "camera", "keep measured responses of cameras, to use them again", CAMERA_EXAMPLES)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION", parser_class=Parser)
    addition = add_action(actions, "add", "keep a measured response")
    addition.add_argument(
        "--from-calibration", type=Path, required=True, metavar="FILE", help="the JSON that crfnet calibrate wrote"
    )
    addition.add_argument("--name", metavar="NAME", help="the camera's name (by default FILE's)")
    addition.add_argument("--overwrite", action="store_true", help="replace the camera of this name")
    add_action(actions, "list", "list your cameras and the ones that come with crfnet")
    for action, words in (("show", "show how good the response of a camera is"), ("remove", "remove a camera")):
        add_action(actions, action, words).add_argument("name", metavar="NAME", help="the camera")
    export = add_action(actions, "export", "write the response of a camera to a file")
    export.add_argument("name", metavar="NAME", help="the camera")
    export.add_argument("out", type=written_path, metavar="OUT", help="a LUT, or .json to hand the camera on")
    export.add_argument("--overwrite", action="store_true", help="replace a file that is already there")


def _add_config(commands: Commands) -> None:
    """Add `crfnet config` and its two actions."""
    parser = add_command(commands, "config", "write a config that knows plates, built on a studio's", CONFIG_EXAMPLES)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION", parser_class=Parser)
    addition = add_action(actions, "add", "write a new config: another one with plates added")
    addition.add_argument("looks", nargs="+", type=Path, metavar="LOOK", help="folder, JSON or LUT")
    addition.add_argument("--base", required=True, metavar="CONFIG", help="the config to build on; it is not changed")
    addition.add_argument(
        "--out", type=written_path, required=True, metavar="FOLDER", help="folder for config.ocio and the LUTs"
    )
    addition.add_argument("--overwrite", action="store_true", help="replace files that are already there")
    listing = add_action(actions, "list", "list the plates of a config")
    listing.add_argument("config", metavar="CONFIG", help="the config")


def _add_info(commands: Commands) -> None:
    """Add `crfnet info`."""
    parser = add_command(commands, "info", "say what a LUT file holds", INFO_EXAMPLES)
    parser.add_argument("lut", type=Path, metavar="FILE", help="a LUT that OpenColorIO reads")
    add_json(parser)

"""The whole command line of `crfnet`; `parts` has the options that subcommands share."""

import argparse

from . import parts
from .parts import Commands, Parser, given_path

NO_SHEET = "do not draw the sheet, the picture of the result"

ESTIMATE_EXAMPLES = """examples:
  crfnet estimate plate01.jpg --out look
  crfnet estimate day1/*.jpg --out look                        # photographs of one camera: one response
  crfnet estimate cam_a.jpg cam_b.jpg --each --out look        # photographs of two cameras: two responses
  crfnet estimate photographs/ --each --no-sheet --no-linear --out responses   # a folder; repeat to continue
  crfnet estimate clip.mp4 --out look                          # a movie: up to 8 of its frames, one response
  crfnet estimate shot.%04d.dpx --frames 1001-1100 --out look  # a sequence: up to 8 of these frames
  crfnet estimate scan.tif --out look --prior any              # a film scan or old video
  crfnet estimate plate01.jpg --out look --camera "A7 III"     # the measured response of a stored camera

For plate01.jpg the folder then holds LUTs of the inverse response (plate01.spi1d, .cube, .clf), config.ocio,
plate01_linear.exr, plate01_sheet.png (the estimate as a picture) and plate01.json."""

CALIBRATE_EXAMPLES = """examples:
  crfnet calibrate stack/*.jpg --out camera --name eos20d
  crfnet calibrate a.jpg b.jpg c.jpg d.jpg --times 1/60,1/30,1/15,1/8 --out camera
  crfnet calibrate stack/*.jpg --out camera --compare look/plate01.json     # and check an estimate
  crfnet calibrate SHOT.NEF --out camera --name d90         # a raw file, and the JPEG beside or inside it
  crfnet calibrate raw/ --out camera --name d90             # all raw files of a folder, each with its JPEG

A stack is one still scene, from a tripod, in 4 or more frames a stop or so apart: the darkest has hardly any white,
the brightest is mostly white. Fix ISO, aperture, white balance and the picture style; switch off automatic tones.
For eos20d the folder then holds LUTs of the inverse response (eos20d.spi1d, .cube, .clf), config.ocio,
eos20d_sheet.png (the points of every frame on the curve) and eos20d.json.

A raw file and the camera's JPEG of the same shot are enough; several shots of one picture style are measured together.
This needs rawpy and SciPy: pip install 'crfnet[calibrate]'."""

LINEARIZE_EXAMPLES = """examples:
  crfnet linearize plate01.jpg --lut look/plate01.spi1d --out plate01_linear.exr
  crfnet linearize shot.%04d.png --lut look/plate01.spi1d --out linear/shot.%04d.exr
  crfnet linearize shot.%04d.png --camera "A7 III" --out linear/shot.%04d.exr
  crfnet linearize 'shot.####.jpg' --frames 1001-1100 --out 'linear/shot.####.exr'
  crfnet linearize clip.mov --frames 1-100 --lut look/clip.spi1d --out linear/clip.%04d.exr
  crfnet linearize photographs/ --each --camera "A7 III" --out linear   # a folder; repeat to continue

Without --lut and --camera one response is estimated from up to 8 of the frames. Frames that are already written are
left alone, so the same command continues an interrupted run. The first frame of a movie has number 1."""

CAMERA_EXAMPLES = """examples:
  crfnet camera add --from-calibration camera/a7.json --name "A7 III"
  crfnet camera list
  crfnet camera show "A7 III"                   # its uncertainty
  crfnet camera export "A7 III" a7.spi1d        # or .cube, .clf; .json to hand the camera on
  crfnet camera remove "A7 III"
  crfnet estimate plate.jpg --camera "A7 III" --out look

Each picture mode of a camera has a response of its own, so store it under a name of its own. A camera is a JSON file in
the user's data folder, or in $CRFNET_DATA_DIR; crfnet camera list names the folder."""

CONFIG_EXAMPLES = """examples:
  crfnet config add --base /studio/config.ocio --out show look
  crfnet config add --base ocio://studio-config-v2.2.0_aces-v1.3_ocio-v2.4 --out show look night/plate02.json
  crfnet config add --base '$OCIO' --out show look/plate01.spi1d
  crfnet config list show

ESTIMATE is a result of crfnet estimate: its folder, its JSON or a LUT. CONFIG is a file, the name of a config that is
built into OpenColorIO, $OCIO, or the folder or executable of a Blender. It is not changed: the new config in FOLDER has
everything in it and the color spaces of the plates, and finds the LUTs of CONFIG where they are."""

INFO_EXAMPLES = "examples:\n  crfnet info look/plate01.spi1d"


class _Version(argparse.Action):
    """Print the version, which takes half as long to look up as everything else takes to start."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        print(parser.prog, version("crfnet"), flush=True)  # noqa: T201
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
    for add in (_add_estimate, _add_linearize, _add_calibrate, _add_camera, _add_config, _add_info):
        add(commands)
    return parser


def _add_estimate(commands: Commands) -> None:
    summary = "estimate the response of the camera that took a photograph"
    parser = parts.add_command(commands, "estimate", summary, ESTIMATE_EXAMPLES)
    photos = "photograph, movie, or sequence such as shot.%%04d.png"
    parts.add_value(parser, "photos", "PHOTO", photos, given_path, nargs="+")
    parts.add_out(parser, "DIR", "folder for all files")
    parts.add_frames(parser, "estimate one response for each photograph, not one for all; PHOTO may be a folder")
    parts.add_flag(parser, "--forward", "also write the response itself as a LUT, from light to code values")
    parts.add_flag(parser, "--no-sheet", NO_SHEET)
    parts.add_flag(parser, "--no-linear", "do not write linear EXR files")
    parts.add_network(parser)
    parts.add_plate(parser)


def _add_linearize(commands: Commands) -> None:
    summary = "write plates, sequences or movies as linear EXR"
    parser = parts.add_command(commands, "linearize", summary, LINEARIZE_EXAMPLES)
    plates = "photograph, movie, folder with one sequence, or sequence such as shot.%%04d.png or shot.####.png"
    each = "; with --each photographs and folders"
    parts.add_value(parser, "plates", "PLATES", plates + each, nargs="+")
    parts.add_out(parser, "PATTERN", "EXR file; for a sequence a name such as l.%%04d.exr; with --each a folder")
    lut = "response to use: a 1D LUT of any format that OpenColorIO reads"
    parts.add_value(parser, "--lut", "FILE", lut, given_path)
    parts.add_frames(parser, "PLATES are photographs, each with its own response without --lut and --camera")
    parts.add_flag(parser, "--encoded", "for --lut and --camera: OpenEXR plates without a stated encoding are encoded")
    parts.add_network(parser)
    parts.add_plate(parser)


def _add_calibrate(commands: Commands) -> None:
    summary = "measure a camera's response from an exposure stack, or from raw files and their JPEGs"
    parser = parts.add_command(commands, "calibrate", summary, CALIBRATE_EXAMPLES)
    files = "frames of a stack; or raw files, their JPEGs, folders of both"
    parts.add_value(parser, "photos", "FILE", files, given_path, nargs="+")
    parts.add_out(parser, "DIR", "folder for all files")
    parts.add_value(parser, "--name", "NAME", "name of the files and of the color space (default: the first file's)")
    parts.add_value(parser, "--times", "LIST", "exposure times in seconds, in the order of the frames (default: EXIF)")
    compare = "response to compare with the measured one: the JSON of an estimate, or a LUT"
    parts.add_value(parser, "--compare", "FILE", compare, given_path)
    parts.add_flag(parser, "--accept-edited", "accept files that a program has edited: the response is the program's")
    parts.add_flag(parser, "--no-sheet", NO_SHEET)
    parts.add_flag(parser, "--overwrite", parts.OVERWRITE)
    parts.add_json(parser)


def _add_camera(commands: Commands) -> None:
    summary = "store measured responses of cameras, to use them with --camera"
    parser = parts.add_command(commands, "camera", summary, CAMERA_EXAMPLES)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION", parser_class=Parser)
    addition = parts.add_action(actions, "add", "store a measured response")
    calibration = "the JSON file of crfnet calibrate, or of crfnet camera export"
    parts.add_value(addition, "--from-calibration", "FILE", calibration, given_path, required=True)
    parts.add_value(addition, "--name", "NAME", "name of the camera (default: FILE's)")
    parts.add_flag(addition, "--overwrite", "replace the camera of this name")
    parts.add_action(actions, "list", "list your cameras and the packaged ones")
    show = parts.add_action(actions, "show", "show a camera and the uncertainty of its response")
    remove = parts.add_action(actions, "remove", "remove one of your cameras")
    export = parts.add_action(actions, "export", "write the response of a camera to a file")
    for action in (show, remove, export):
        parts.add_value(action, "name", "NAME", "the camera")
    parts.add_value(export, "out", "OUT", "a LUT file, or .json to hand the camera on", given_path)
    parts.add_flag(export, "--overwrite", parts.OVERWRITE)


def _add_config(commands: Commands) -> None:
    summary = "add the color spaces of plates to a copy of an OpenColorIO config"
    parser = parts.add_command(commands, "config", summary, CONFIG_EXAMPLES)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION", parser_class=Parser)
    addition = parts.add_action(actions, "add", "write a new config: CONFIG with the color spaces of plates")
    parts.add_value(addition, "looks", "ESTIMATE", "folder, JSON or LUT of crfnet estimate", given_path, nargs="+")
    parts.add_value(addition, "--base", "CONFIG", "config to build on; it is not changed", required=True)
    parts.add_out(addition, "FOLDER", "folder for config.ocio and the LUTs")
    parts.add_flag(addition, "--overwrite", parts.OVERWRITE)
    listing = parts.add_action(actions, "list", "list the plates of a config")
    parts.add_value(listing, "config", "CONFIG", "config with plates")


def _add_info(commands: Commands) -> None:
    parser = parts.add_command(commands, "info", "describe a LUT file", INFO_EXAMPLES)
    parts.add_value(parser, "lut", "FILE", "LUT that OpenColorIO reads", given_path)
    parts.add_json(parser)

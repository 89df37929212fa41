"""`crfnet camera`: its arguments."""

from __future__ import annotations

from pathlib import Path

from .parts import Commands, Parser, add_action, add_command, written_path

EXAMPLES = """examples:
  crfnet camera add --from-calibration camera/a7.json --name "A7 III"    measured by crfnet calibrate
  crfnet camera list
  crfnet camera show "A7 III"                                  how good the response is
  crfnet camera export "A7 III" a7.spi1d                       or .cube, .clf, or .json to hand it on
  crfnet camera remove "A7 III"
  crfnet estimate plate.jpg --camera "A7 III" --out look

One name is for one picture mode: a camera set to another has another response. The library is a folder of JSON files
among the user's data, or in $CRFNET_DATA_DIR."""


def add(commands: Commands) -> None:
    """Add `crfnet camera` and its five actions."""
    parser = add_command(commands, "camera", "keep measured responses of cameras, to use them again", EXAMPLES)
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

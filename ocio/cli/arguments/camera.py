"""`crfnet camera`: its arguments."""

from __future__ import annotations

from pathlib import Path

from .parts import Commands, Parser, add_action, add_command, add_model, written_path

EXAMPLES = """examples:
  crfnet camera add "A7 III" IMG_1.jpg IMG_2.jpg               one response for all plates; more may be added later
  crfnet camera add "A7 III" --from-calibration camera/a7.json    its measured response, from crfnet calibrate
  crfnet camera list
  crfnet camera show "A7 III"                                  how good the response is, and what disagrees with it
  crfnet camera remove "A7 III" IMG_2.jpg                      or its SHA-256, where two have one name
  crfnet camera export "A7 III" a7.spi1d                       or another LUT format, or .json
  crfnet estimate plate.jpg --camera "A7 III" --out look

Of photographs the evidence is kept, not the pixels. One name is for one picture mode: a camera set to another has
another response. The library is a folder of JSON files among the user's data, or in $CRFNET_DATA_DIR."""


def add(commands: Commands) -> None:
    """Add `crfnet camera` and its five actions."""
    parser = add_command(commands, "camera", "keep the responses of cameras, to use them again", EXAMPLES)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION", parser_class=Parser)
    _add_add(actions)
    add_action(actions, "list", "list your cameras and the measured ones that come with crfnet")
    shown = add_action(actions, "show", "show what is known of a camera")
    shown.add_argument("name", metavar="NAME", help="the camera")
    add_model(shown)
    removal = add_action(actions, "remove", "remove a camera, or photographs of it")
    removal.add_argument("name", metavar="NAME", help="the camera")
    removal.add_argument("photos", nargs="*", metavar="PHOTO", help="only these photographs, by file name or SHA-256")
    _add_export(actions)


def _add_add(actions: Commands) -> None:
    """Add `crfnet camera add`."""
    parser = add_action(actions, "add", "add photographs, or a measured response, to a camera")
    parser.add_argument("name", metavar="NAME", help="what you call the camera; a new name makes a new one")
    parser.add_argument("photos", nargs="*", type=Path, metavar="PHOTO", help="as the camera wrote it")
    parser.add_argument("--from-calibration", type=Path, metavar="FILE", help="the JSON that crfnet calibrate wrote")
    add_model(parser)
    parser.add_argument("--overwrite", action="store_true", help="replace the measured response")


def _add_export(actions: Commands) -> None:
    """Add `crfnet camera export`."""
    parser = add_action(actions, "export", "write the response of a camera to a file")
    parser.add_argument("name", metavar="NAME", help="the camera")
    parser.add_argument(
        "out",
        type=written_path,
        metavar="OUT",
        help="a LUT, or .json to hand it on",
    )
    add_model(parser)
    parser.add_argument("--overwrite", action="store_true", help="replace a file that is already there")

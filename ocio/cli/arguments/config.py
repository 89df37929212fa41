"""`crfnet config`: its arguments."""

from __future__ import annotations

from pathlib import Path

from .parts import Commands, Parser, add_action, add_command, written_path

EXAMPLES = """examples:
  crfnet config add --base /studio/config.ocio --out show look
  crfnet config add --base ocio://studio-config-v2.2.0_aces-v1.3_ocio-v2.4 --out show look night/plate02.json
  crfnet config add --base '$OCIO' --out show look/plate01.spi1d
  crfnet config list show

LOOK is the result of crfnet estimate: its folder, its JSON or a LUT. CONFIG is a file, the name of a config that is
built into OpenColorIO, $OCIO, or the folder or executable of a Blender. It stays as it is: the new config in FOLDER has
everything of it, finds its LUTs where they lie, and knows the plates, too."""


def add(commands: Commands) -> None:
    """Add `crfnet config` and its two actions."""
    parser = add_command(commands, "config", "write a config that knows plates, built on a studio's", EXAMPLES)
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

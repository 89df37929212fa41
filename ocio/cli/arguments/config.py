"""`crfnet config`: its arguments."""

from __future__ import annotations

import argparse
from pathlib import Path

from .parts import Commands, Parser, add_action, add_command, written_path

EXAMPLES = """examples:
  crfnet config add --base /studio/config.ocio look                       into that config; a backup is kept
  crfnet config add --base ocio://studio-config-v2.2.0_aces-v1.3_ocio-v2.4 --out show.ocio look --view
  crfnet config add --base '$OCIO' --out show.ocio look/plate01.spi1d --rule 'shot010/*/IMG_0001.JPG'
  crfnet config list show.ocio
  crfnet config remove show.ocio "CRF plate01"
  crfnet config overlay --base /studio/config.ocio --out overlay.ocio look

LOOK is what crfnet estimate wrote: its folder, its JSON or a LUT. CONFIG is a file, the name of a config that is built
into OpenColorIO, $OCIO, or the folder or executable of a Blender. Everything else in the config stays as it is."""

PATTERN_HELP = "with * and ?, and # for a number; in any folder, in upper and lower case"


def add(commands: Commands) -> None:
    """Add `crfnet config` and its four actions."""
    parser = add_command(commands, "config", "put plates into a studio's or a program's OpenColorIO config", EXAMPLES)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION", parser_class=Parser)
    _add_add(actions)
    _add_overlay(actions)
    listing = add_action(actions, "list", "list the plates of a config")
    listing.add_argument("config", metavar="CONFIG", help="the config")
    removal = add_action(actions, "remove", "take plates out of a config")
    removal.add_argument("config", metavar="CONFIG", help="the config")
    removal.add_argument("names", nargs="+", metavar="NAME", help='a color space, like "CRF plate01"')


def _add_add(actions: Commands) -> None:
    """Add `crfnet config add`."""
    parser = add_action(actions, "add", "put plates into a config")
    _add_looks(parser, base="the config to add to")
    _add_out(parser, required=False, words="write here, and leave CONFIG as it is: a file, or a folder for config.ocio")
    parser.add_argument(
        "--rule", action="append", default=[], metavar="PATTERN", help=f"names of the plate's files, {PATTERN_HELP}"
    )
    parser.add_argument(
        "--linear-rule",
        action="append",
        default=[],
        metavar="PATTERN",
        help="names of its linear files",
    )
    parser.add_argument("--no-rules", action="store_true", help="no file rules at all")
    parser.add_argument(
        "--view", action="store_true", help='add the views "As photographed": the scene through the camera response'
    )


def _add_overlay(actions: Commands) -> None:
    """Add `crfnet config overlay`."""
    parser = add_action(actions, "overlay", "write a config of plates alone, and a merge file for ociomergeconfigs")
    _add_looks(parser, base="the config to merge with; it is not changed")
    _add_out(parser, required=True, words="the config to write; the merge file has its name, with .ociom")


def _add_looks(parser: argparse.ArgumentParser, *, base: str) -> None:
    """Add what goes where."""
    parser.add_argument("looks", nargs="+", type=Path, metavar="LOOK", help="folder, JSON or LUT")
    parser.add_argument("--base", required=True, metavar="CONFIG", help=base)


def _add_out(parser: argparse.ArgumentParser, *, required: bool, words: str) -> None:
    """Add --out and --overwrite."""
    parser.add_argument("--out", type=written_path, required=required, metavar="FILE", help=words)
    parser.add_argument("--overwrite", action="store_true", help="replace files that are already there")

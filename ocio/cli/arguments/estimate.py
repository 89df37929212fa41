"""`crfnet estimate`: its arguments."""

from __future__ import annotations

from pathlib import Path

from .parts import Commands, add_command, add_frames, add_network, add_plate, written_path

EXAMPLES = """examples:
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


def add(commands: Commands) -> None:
    """Add `crfnet estimate`."""
    parser = add_command(commands, "estimate", "estimate the response of the camera that took a photograph", EXAMPLES)
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

"""The metadata of an image file, from its header."""

from dataclasses import dataclass, field, replace
from typing import Any

from crfnet_core.errors import one_line
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.metadata.header_colors import header_attribute, header_color_tags
from crfnet_core.types import CheckedFields

Table = tuple[int, ...]  # a quantization table: 64 divisors, row by row

#: Longest text that is kept, in characters: names of programs are shorter, and a file may hold anything.
LONGEST_TEXT = 200

#: Our name of EXIF Software in a header; OpenImageIO's `Software` is XMP's CreatorTool, the first program, where it is
#: known.
SOFTWARE = "Exif:Software"

#: Entry of the header of a PNG or JPEG file that a renderer writes, unless its settings say otherwise -> the renderer.
RENDERERS = {"RenderTime": "Blender", "Blender:RenderTime": "Blender"}


@dataclass(frozen=True)
class FileMetadata(CheckedFields):
    """The metadata of an image file; a field is empty or None where the file does not state it. Texts are printable."""

    width: int = 0  # of the upright picture, in pixels
    height: int = 0
    make: str = ""  # EXIF Make and Model: the camera, as it writes itself
    model: str = ""
    software: str = ""  # EXIF Software: the program that wrote the file last, or the camera's firmware
    history: tuple[str, ...] = ()  # XMP's CreatorTool, and the programs in its history that saved pixels, in order
    raw_file: str = ""  # XMP crs:RawFileName: the file that a program of Adobe developed; it may be an ordinary picture
    derived_from: str = ""  # XMP xmpMM:DerivedFrom, if it is a text: to darktable, the file that it developed
    renderer: str = ""  # the program that rendered the picture, so that no camera took it
    iso: int | None = None  # EXIF PhotographicSensitivity
    exif_size: tuple[int, int] | None = None  # EXIF PixelXDimension and PixelYDimension, by the camera or an editor
    luma_table: Table = ()  # quantization tables of a JPEG file
    chroma_table: Table = ()
    has_jfif: bool = False  # a JPEG segment that libraries write; cameras begin with EXIF instead
    has_adobe: bool = False  # a JPEG segment of Adobe's programs, and of other encoders for CMYK and RGB
    interop_index: str = ""  # EXIF InteroperabilityIndex of a JPEG file, such as "R98"
    file_format: str = ""  # "JPEG", "HEIC", "DPX" and so on, as in `image_io.file_kinds`; "movie" for a frame of one
    has_gain_map: bool = False  # whether the picture is the base of an HDR picture
    color: ColorTags = field(default_factory=ColorTags)  # the tags of its primaries and of its encoding
    is_turned: bool = False  # whether the reader has turned the picture upright
    is_unread: bool = False  # whether EXIF or XMP is compressed, so that the camera is in the file and not here

    @property
    def has_camera(self) -> bool:
        """Whether the file names the camera."""
        return bool(self.make or self.model)


def metadata_of_header(header: Any, file_format: str, jpeg: FileMetadata | None = None) -> FileMetadata:
    """Return the metadata in an open file's header, and in the segments of a JPEG; damaged fields stay empty."""
    jpeg = jpeg or FileMetadata()
    sides = _number(header, "Exif:PixelXDimension"), _number(header, "Exif:PixelYDimension")
    creator = _text(header, "Software")
    software = one_line(jpeg.software or _text(header, SOFTWARE) or creator)
    agents, changed = (_list(header, f"stEvt:{name}") for name in ("softwareAgent", "changed"))
    if len(agents) == len(changed):  # programs that saved nothing but metadata, such as ratings, are left out
        agents = [agent for agent, parts in zip(agents, changed, strict=True) if parts != "/metadata"]
    has_profile = header_attribute(header, "ICCProfile") is not None  # else OpenImageIO has left out a damaged one
    color = header_color_tags(header, file_format, jpeg.interop_index)
    return replace(
        jpeg,
        width=header.width,
        height=header.height,
        make=_text(header, "Make"),
        model=_text(header, "Model"),
        software=software,
        history=(*[creator] * (creator != software), *agents),
        raw_file=_text(header, "crs:RawFileName") * (_text(header, "crs:AlreadyApplied") != "False"),
        derived_from=_text(header, "xmpMM:DerivedFrom"),
        renderer=next((name for entry, name in RENDERERS.items() if _text(header, entry)), ""),
        iso=_number(header, "Exif:PhotographicSensitivity"),
        exif_size=(sides[0], sides[1]) if sides[0] and sides[1] else None,
        file_format=file_format,
        color=color if color.source or has_profile else replace(color, source=jpeg.color.source),
    )


def _text(header: Any, name: str, *, longest: int = LONGEST_TEXT) -> str:
    """Return a text in the header on one line of printable characters."""
    value = header_attribute(header, name)
    return one_line(value.rstrip("\0")[:longest]) if isinstance(value, str) else ""


def _list(header: Any, name: str) -> list[str]:
    """Return the texts of a list in the header, which OpenImageIO joins."""
    parts = _text(header, name, longest=10 * LONGEST_TEXT).split(";")
    return [part.strip() for part in parts if part.strip()]


def _number(header: Any, name: str) -> int | None:
    """Return a positive whole number in the header."""
    value = header_attribute(header, name)
    return value if isinstance(value, int) and value > 0 else None

"""The metadata of an image file, from its header."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from crfnet_core.errors import one_line
from crfnet_core.photograph.metadata.color_tags import ColorTags, dpx_transfer, with_named_transfer
from crfnet_core.photograph.metadata.header_colors import header_attribute, header_color_tags

#: A quantization table: 64 divisors, row by row.
Table = tuple[int, ...]

#: Longest text that is kept, in characters: names of programs are shorter, and a file may hold anything.
LONGEST_TEXT = 200

#: Entry of a header that a renderer writes -> the renderer. Blender writes it into the PNG and the JPEG files of a
#: render, unless the scene's metadata says otherwise.
RENDERERS = {"RenderTime": "Blender", "Blender:RenderTime": "Blender"}


@dataclass(frozen=True)
class FileMetadata:
    """The metadata of an image file; a field is empty or None where the file does not state it.

    Texts hold printable characters only, and no spaces at their ends.

    Parameters
    ----------
    width, height : int
        The upright picture in pixels; 0 if unknown.
    make, model : str
        The camera, as it writes itself: EXIF Make and Model.
    software : str
        The program that wrote the file last, or the camera's firmware: EXIF Software.
    history : tuple of str
        Programs in the XMP history (stEvt:softwareAgent), the first first.
    raw_file : str
        The file that a program of Adobe developed: Camera Raw's crs:RawFileName in XMP. It may be an ordinary picture.
    renderer : str
        The program that rendered the picture, so that no camera took it.
    iso : int, optional
        EXIF PhotographicSensitivity.
    exif_size : (int, int), optional
        EXIF PixelXDimension and PixelYDimension: the size that the camera, or an editor, wrote.
    luma_table, chroma_table : tuple of int
        Quantization tables of a JPEG file, 64 divisors each, row by row.
    subsampling : str
        Chroma subsampling of a JPEG file, such as "4:2:0".
    has_jfif, has_adobe : bool
        Whether a JPEG file has a JFIF segment, which libraries write (cameras begin with EXIF instead), and an Adobe
        segment, which the programs of Adobe write, and other encoders for CMYK and RGB.
    interop_index : str
        EXIF InteroperabilityIndex of a JPEG file, such as "R98".
    profile : str
        Description of the ICC profile; of DPX its transfer characteristic.
    file_format : str
        "JPEG", "HEIC", "DPX" and so on, as `image_io.file_kinds` names them; "movie" for a frame of one.
    has_gain_map : bool
        Whether the file holds a gain map, so that its picture is the base of an HDR picture.
    alpha : str
        "straight" or "multiplied": whether the colors of a file with alpha are stored multiplied by it; else empty.
    color : ColorTags
        The tags of its primaries and of its encoding.
    is_turned : bool
        Whether the file stores the picture in another orientation, and the reader has turned it upright.
    """

    width: int = 0
    height: int = 0
    make: str = ""
    model: str = ""
    software: str = ""
    history: tuple[str, ...] = ()
    raw_file: str = ""
    renderer: str = ""
    iso: int | None = None
    exif_size: tuple[int, int] | None = None
    luma_table: Table = ()
    chroma_table: Table = ()
    subsampling: str = ""
    has_jfif: bool = False
    has_adobe: bool = False
    interop_index: str = ""
    profile: str = ""
    file_format: str = ""
    has_gain_map: bool = False
    alpha: str = ""
    color: ColorTags = field(default_factory=ColorTags)
    is_turned: bool = False

    @property
    def has_camera(self) -> bool:
        """Whether the file names the camera."""
        return bool(self.make or self.model)


#: The metadata of a file that states nothing.
EMPTY = FileMetadata()


def metadata_of_header(header: Any, file_format: str, jpeg: FileMetadata = EMPTY) -> FileMetadata:
    """Return the metadata in an open file's header; what is damaged stays empty.

    Parameters
    ----------
    header : OpenImageIO.ImageSpec
        Of the picture that is read.
    file_format : str
        "JPEG", "HEIC", "DPX" and so on, as `image_io.file_kinds` names them.
    jpeg : FileMetadata, optional
        The metadata in the segments of a JPEG file, by `read_jpeg_header`.
    """
    sides = _number(header, "Exif:PixelXDimension"), _number(header, "Exif:PixelYDimension")
    history = _text(header, "stEvt:softwareAgent", longest=10 * LONGEST_TEXT)
    profile = _text(header, "ICCProfile:profile_description")
    dpx = dpx_transfer(_text(header, "dpx:Transfer"))
    return replace(
        jpeg,
        width=header.width,
        height=header.height,
        make=_text(header, "Make"),
        model=_text(header, "Model"),
        software=_text(header, "Software"),
        history=tuple(part.strip() for part in history.split(";") if part.strip()),
        raw_file=_text(header, "crs:RawFileName"),
        renderer=next((name for entry, name in RENDERERS.items() if _text(header, entry)), ""),
        iso=_number(header, "Exif:PhotographicSensitivity"),
        exif_size=(sides[0], sides[1]) if sides[0] and sides[1] else None,
        profile=profile or dpx,
        file_format=file_format,
        alpha=_alpha(header),
        color=with_named_transfer(header_color_tags(header, file_format, jpeg.interop_index), dpx, profile),
    )


def _text(header: Any, name: str, *, longest: int = LONGEST_TEXT) -> str:
    """Return a text in the header on one line of printable characters."""
    value = header_attribute(header, name)
    return one_line(value.rstrip("\0")[:longest]) if isinstance(value, str) else ""


def _alpha(header: Any) -> str:
    """Return how colors are stored with alpha, in a file that was opened to be read as it is stored."""
    if header.alpha_channel < 0:
        return ""
    return "straight" if header.get_int_attribute("oiio:UnassociatedAlpha") else "multiplied"


def _number(header: Any, name: str) -> int | None:
    """Return a positive whole number in the header."""
    value = header_attribute(header, name)
    return value if isinstance(value, int) and value > 0 else None

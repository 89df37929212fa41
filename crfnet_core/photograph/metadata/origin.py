"""The history of a photograph before it was read: which device took it, and which programs changed the file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from enum import StrEnum
from typing import Any

from crfnet_core.photograph.metadata.devices import Device, camera_name, device_of
from crfnet_core.photograph.metadata.editors import editor_name, is_developer
from crfnet_core.photograph.metadata.file_metadata import FileMetadata
from crfnet_core.photograph.metadata.jpeg import ijg_quality

#: The editor of a file that has a segment of Adobe, or names a raw file, but does not name a program; and ends, in
#: lower case, of the names of files that are not raw.
ADOBE = "a program of Adobe"
ORDINARY_FILES = (".jpg", ".jpeg", ".tif", ".tiff", ".png", ".psd", ".heic", ".heif", ".webp", ".avif", ".jxl")

#: Shapes of a picture -> ratio of its longer side to the shorter, and how far from it a picture may be, in ratio.
#: 18:9 to 20:9 are the screens of phones. And how far from the ratio in EXIF: scaled sides are rounded.
SHAPES = {"3:2": (1.5, 0.012), "4:3": (4 / 3, 0.012), "16:9": (16 / 9, 0.015), "2:1": (2.1, 0.07)}
SAME_SHAPE = 0.02

#: Longest side in pixels below which a picture counts as scaled, unless EXIF has the same size and both sides are whole
#: blocks: the smallest size of cameras of the last fifteen years has 1600 pixels, the sizes of web pages end at 1280.
#: And the longest sides to which messengers and photograph sites scale.
SCALED_BELOW, WEB_SIDES = 1600, (1600, 1920, 2048)

#: The longer and the shorter side of a camera's picture are multiples of these; since 2004 it has this many pixels.
NATIVE_MULTIPLES, NATIVE_PIXELS = (16, 8), 5_000_000

#: From the first quality on the tables of the IJG library are nearly all ones, as in many cameras. Messengers and web
#: sites send copies of at most the second; pages of photographers have 90 and more.
INDISTINCT_QUALITY, SENT_QUALITY = 98, 85


class Encoding(StrEnum):
    """The encoding of a format that holds no still photographs."""

    FOOTAGE = "film or video"
    MOVIE = "movie"
    UNKNOWN = ""


#: Formats of files that hold no still photographs -> their encoding.
FOOTAGE = {"DPX": Encoding.FOOTAGE, "movie": Encoding.MOVIE}

_DEVICES = {
    Device.PHONE: "a phone",
    Device.COMPACT: "a compact camera",
    Device.CAMERA: "a camera with interchangeable lenses",
    Device.SCANNER: "a scanner of film or paper",
}


@dataclass(frozen=True)
class FileOrigin:
    """How a file was made, by its metadata; texts are empty where nothing is known."""

    device: Device
    camera: str  # maker and model
    editor: str  # the program that edited or developed the photograph
    is_scaled: bool | None  # after the camera took it; None if unknown
    is_resaved: bool | None  # whether a program encoded the file; False if just as the camera wrote it
    jpeg_quality: int | None  # at which the IJG library writes the file's quantization tables; None for other tables
    picture_shape: str  # ratio of the sides: "3:2", "4:3", "16:9", "2:1" or "other"
    encoding: Encoding
    words: tuple[str, ...]  # the same in plain words, one part of a sentence each
    renderer: str = ""  # the program that rendered the picture, so that no camera took it
    is_developed: bool = False  # by a program, from a raw file: XMP names the file, or the editor is such a program
    is_told: bool = False  # whether a person has stated the device: see `with_stated_device`

    @property
    def names_device(self) -> bool:
        """Whether the file or the user states what took the picture."""
        return bool(self.camera) or self.is_told

    @property
    def is_sent_copy(self) -> bool:
        """Whether messengers and web sites send such files: without a camera, scaled, and strongly compressed."""
        is_compressed = self.jpeg_quality is not None and self.jpeg_quality <= SENT_QUALITY
        return is_compressed and self.is_scaled is True and not self.names_device

    @classmethod
    def from_dict(cls, entry: Mapping[str, Any]) -> FileOrigin:
        """Return the origin that `dataclasses.asdict` made an entry of, also after JSON; other entries are left out."""
        known = {each.name: entry[each.name] for each in fields(cls) if each.name in entry}
        kinds = {"device": Device(entry["device"]), "encoding": Encoding(entry["encoding"])}
        return cls(**{**known, **kinds, "words": tuple(map(str, entry["words"]))})


def file_origin(metadata: FileMetadata) -> FileOrigin:
    """Return how a file was made, by its metadata."""
    device = device_of(metadata.make, metadata.model)
    is_adobes = metadata.has_adobe or bool(metadata.raw_file)
    editor = editor_name(metadata.software, metadata.history) or (ADOBE if is_adobes else "")
    quality = ijg_quality(metadata.luma_table, metadata.chroma_table)
    encoded_by = _encoded_by_program(metadata, device, quality)
    is_scaled = _is_scaled(metadata, is_changed=bool(editor) or encoded_by is True)
    origin = FileOrigin(
        device=device,
        camera=camera_name(metadata.make, metadata.model),
        editor=editor,
        is_scaled=is_scaled,
        is_resaved=True if editor or is_scaled else encoded_by,
        jpeg_quality=quality,
        picture_shape=picture_shape(metadata.width, metadata.height),
        encoding=FOOTAGE.get(metadata.file_format, Encoding.UNKNOWN),
        words=(),
        renderer=metadata.renderer,
        is_developed=_is_developed(metadata, editor),
    )
    return replace(origin, words=tuple(_words(origin, metadata)))


def with_stated_device(origin: FileOrigin, device: Device) -> FileOrigin:
    """Return `origin` with the device that the user states, UNKNOWN for another camera; a rendering stays one."""
    if origin.renderer:
        return origin
    device = Device(device)
    words = (f"taken with {_DEVICES.get(device, 'a camera')}", *origin.words[1:])
    return replace(origin, device=device, is_told=True, words=words)


def picture_shape(width: int, height: int) -> str:
    """Return the ratio of the sides, whichever is longer: "3:2", "4:3", "16:9", "2:1" (to 20:9) or "other"."""
    longer, shorter = max(width, height), min(width, height)
    if shorter <= 0:
        return "other"
    near = (name for name, (ratio, margin) in SHAPES.items() if abs(longer / shorter / ratio - 1) <= margin)
    return next(near, "other")


def _is_developed(metadata: FileMetadata, editor: str) -> bool:
    """Return whether a program developed the photograph from a raw file; DNG Converter keeps the camera's picture."""
    programs = " ".join((metadata.software, *metadata.history)).casefold()
    if metadata.raw_file and "dng converter" not in programs:
        return not metadata.raw_file.casefold().endswith(ORDINARY_FILES)
    return is_developer(editor)


def _encoded_by_program(metadata: FileMetadata, device: Device, quality: int | None) -> bool | None:
    """Return whether a program encoded a JPEG file, by its segments and tables; None if they do not show it."""
    if metadata.file_format != "JPEG" or not metadata.luma_table:
        return None
    is_ijg = quality is not None and quality < INDISTINCT_QUALITY
    if not metadata.has_camera:
        return True if is_ijg or metadata.has_adobe else None
    if is_ijg or metadata.has_jfif or metadata.has_adobe:
        return True if metadata.has_adobe or (is_ijg and metadata.has_jfif and device != Device.PHONE) else None
    return False


def _is_scaled(metadata: FileMetadata, *, is_changed: bool) -> bool | None:
    """Return whether the picture was scaled, by the size in EXIF and by usual sizes; None if it may have been cut."""
    size = sorted((metadata.width, metadata.height))
    exif_size = sorted(metadata.exif_size or ())
    if size[0] <= 0:
        return None
    if exif_size and exif_size != size:
        ratios = size[0] / exif_size[0], size[1] / exif_size[1]
        return True if size[1] > exif_size[1] or abs(ratios[0] / ratios[1] - 1) < SAME_SHAPE else None
    is_whole = (size[1] >= SCALED_BELOW and size[1] not in WEB_SIDES) or _is_in_blocks(*size)
    if exif_size and metadata.has_camera and not is_changed and is_whole:  # programs that scale may rewrite the size
        return False
    if metadata.file_format in FOOTAGE:
        return None
    if size[1] < SCALED_BELOW or (size[1] in WEB_SIDES and metadata.file_format == "JPEG" and not metadata.has_camera):
        return True
    is_large, is_of_sensor = size[0] * size[1] >= NATIVE_PIXELS, picture_shape(*size) != "other"
    return False if is_large and is_of_sensor and _is_in_blocks(*size) else None


def _is_in_blocks(shorter: int, longer: int) -> bool:
    """Return whether the sides are multiples of a camera's blocks."""
    return longer % NATIVE_MULTIPLES[0] == 0 and shorter % NATIVE_MULTIPLES[1] == 0


def _words(origin: FileOrigin, metadata: FileMetadata) -> Iterator[str]:
    """Yield the words for an origin, one part of a sentence each."""
    if origin.renderer or not origin.camera:
        yield f"rendered by {origin.renderer}" if origin.renderer else "the file names no camera"
    else:
        yield f"taken by {origin.camera}" + (f", {_DEVICES[origin.device]}" if origin.device else "")
    if origin.editor:
        yield f"developed from a raw file by {origin.editor}" if origin.is_developed else f"saved by {origin.editor}"
    elif origin.is_resaved is False:
        yield "the file is as the camera wrote it"
    elif origin.is_resaved and not origin.is_scaled:
        quality = origin.jpeg_quality
        yield "encoded again by a program" + (f", as JPEG of quality {quality}" if quality else "")
    size, exif_size = (metadata.width, metadata.height), metadata.exif_size
    if origin.is_scaled and exif_size and sorted(exif_size) != sorted(size):
        before, now = (f"{width} x {height}" for width, height in (exif_size, size))
        yield f"scaled from {before} to {now} pixels after the camera wrote it"
    elif origin.is_scaled:
        yield f"probably scaled after the camera wrote it ({size[0]} x {size[1]} pixels)"
    if metadata.is_turned:
        yield "turned upright, as the file asks"
    if origin.encoding:
        is_movie = origin.encoding == Encoding.MOVIE
        yield "a frame of a movie" if is_movie else f"{metadata.file_format} files hold {origin.encoding}"

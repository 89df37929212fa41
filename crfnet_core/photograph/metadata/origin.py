"""The history of a photograph before it was read: which device took it, and which programs changed the file."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

from crfnet_core.photograph.metadata.devices import Device, camera_name, device_of
from crfnet_core.photograph.metadata.editors import editor_name, is_developer
from crfnet_core.photograph.metadata.file_metadata import FileMetadata
from crfnet_core.photograph.metadata.jpeg import ijg_quality

#: The editor of a file that has a segment of Adobe, or names a raw file, but does not name a program; and ends, in
#: lower case, of the names of files that are not raw.
ADOBE = "a program of Adobe"
ORDINARY_FILES = (".jpg", ".jpeg", ".tif", ".tiff", ".png", ".psd", ".heic", ".heif", ".webp", ".avif", ".jxl")

#: Shapes of a picture -> ratio of its longer side to the shorter, and how far from it a picture may be, as a part of
#: it. 18:9 to 20:9 are the screens of phones.
SHAPES = {"3:2": (1.5, 0.012), "4:3": (4 / 3, 0.012), "16:9": (16 / 9, 0.015), "2:1": (2.1, 0.07)}

#: How far a scaled picture may be from the shape in EXIF, since its sides are rounded; farther off, it was cut. A
#: picture that is smaller by less lost a few pixels at its border, and one that is larger than MOST_ENLARGED times the
#: size in EXIF was not enlarged: some cameras write the size of the thumbnail.
SAME_SHAPE, MOST_ENLARGED = 0.02, 8

#: Longest side in pixels below which a picture counts as scaled, unless EXIF has the same size and both sides are whole
#: blocks: the smallest size of cameras of the last fifteen years has 1600 pixels, the sizes of web pages end at 1280.
#: And the longest sides to which messengers and photograph sites scale.
SCALED_BELOW, WEB_SIDES = 1600, (1600, 1920, 2048)

#: The longer and the shorter side of a camera's picture are multiples of these; since 2004 it has this many pixels.
NATIVE_MULTIPLES, NATIVE_PIXELS = (16, 8), 5_000_000

INDISTINCT_QUALITY = 98  # from here on the tables of the IJG library are nearly all ones, as in many cameras
SENT_QUALITY = 85  # the most of copies from messengers and web sites; pages of photographers have 90 and more


#: Makers, other than of phones, whose programs write JPEG by the IJG library, in lower case.
LIBRARY_USERS = ("raspberry pi",)


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
    Device.THERMAL: "a thermal camera",
}


@dataclass(frozen=True)
class FileOrigin:
    """How a file was made, by its metadata; texts are empty where nothing is known."""

    device: Device
    camera: str  # maker and model
    editor: str  # the program that edited or developed the photograph
    is_scaled: bool | None  # after the camera took it; None if unknown
    is_resaved: bool | None  # whether a program encoded the file; False if the camera did
    jpeg_quality: int | None  # at which the IJG library writes the file's quantization tables; None for other tables
    picture_shape: str  # ratio of the sides: "3:2", "4:3", "16:9", "2:1" or "other"
    encoding: Encoding
    words: tuple[str, ...]  # the same in plain words, one part of a sentence each
    renderer: str = ""  # the program that rendered the picture, so that no camera took it
    is_developed: bool = False  # by a program, from a raw file: XMP names the file, or the editor is such a program
    has_stated_device: bool = False  # whether a person has stated the device: see `with_stated_device`

    @property
    def names_device(self) -> bool:
        """Whether the file or the user states which camera took the picture: a scanner did not."""
        return self.device is not Device.SCANNER and (bool(self.camera) or self.has_stated_device)

    @property
    def is_phone_still(self) -> bool:
        """Whether the file is a still of a phone: phones write log into movies only."""
        return self.device is Device.PHONE and not self.has_stated_device and self.encoding is Encoding.UNKNOWN

    @property
    def is_sent_copy(self) -> bool:
        """Whether messengers and web sites send such files: without a camera, scaled, and strongly compressed."""
        is_compressed = self.jpeg_quality is not None and self.jpeg_quality <= SENT_QUALITY
        return is_compressed and self.is_scaled is True and not self.names_device


def file_origin(metadata: FileMetadata) -> FileOrigin:
    """Return how a file was made, by its metadata."""
    device = device_of(metadata.make, metadata.model, (metadata.width, metadata.height))
    quality = ijg_quality(metadata.luma_table, metadata.chroma_table)
    encoded_by = _encoded_by_program(metadata, device, quality)
    is_adobes = metadata.has_adobe or (bool(metadata.raw_file) and encoded_by is not False)
    editor = editor_name(metadata.software, metadata.history) or (ADOBE if is_adobes else "")
    size, most = metadata.exif_size, 1 if encoded_by is False and not editor else MOST_ENLARGED
    if size and max(size) * most < max(metadata.width, metadata.height):  # a preview's size: no camera enlarges
        metadata = replace(metadata, exif_size=None)
    is_scaled = _is_scaled(metadata, is_changed=bool(editor) or encoded_by is True)
    source = metadata.raw_file or metadata.derived_from * is_developer(editor)
    is_raw = not source.casefold().endswith(ORDINARY_FILES)
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
        is_developed=is_raw if editor and source else is_developer(editor),
    )
    return replace(origin, words=tuple(_words(origin, metadata)))


def with_stated_device(origin: FileOrigin, device: Device) -> FileOrigin:
    """Return `origin` with the device that the user states, UNKNOWN for another camera; a rendering stays one."""
    if origin.renderer:
        return origin
    words = (f"taken with {_DEVICES.get(device, 'a camera')}", *origin.words[1:])
    return replace(origin, device=device, has_stated_device=True, words=words)


def picture_shape(width: int, height: int) -> str:
    """Return the ratio of the sides, whichever is longer: "3:2", "4:3", "16:9", "2:1" (to 20:9) or "other"."""
    longer, shorter = max(width, height), min(width, height)
    if shorter <= 0:
        return "other"
    near = (name for name, (ratio, margin) in SHAPES.items() if abs(longer / shorter / ratio - 1) <= margin)
    return next(near, "other")


def _encoded_by_program(metadata: FileMetadata, device: Device, quality: int | None) -> bool | None:
    """Return whether a program encoded a JPEG file, by its segments and tables; None if they do not show it."""
    if metadata.file_format != "JPEG" or not metadata.luma_table:
        return None
    if metadata.has_adobe:
        return True
    is_ijg = quality is not None and quality < INDISTINCT_QUALITY
    if not metadata.has_camera:
        return True if is_ijg else None
    if is_ijg and metadata.has_jfif:
        uses_library = device == Device.PHONE or metadata.make.casefold().startswith(LIBRARY_USERS)
        return None if uses_library else True
    return None if is_ijg or metadata.has_jfif else False


def _is_scaled(metadata: FileMetadata, *, is_changed: bool) -> bool | None:
    """Return whether the picture was scaled, by the size in EXIF and by usual sizes; None if it may have been cut."""
    shorter, longer = size = tuple(sorted((metadata.width, metadata.height)))
    exif_size = tuple(sorted(metadata.exif_size or size))
    if shorter <= 0 or metadata.is_unread:
        return None
    if exif_size != size:
        return _is_scaled_from(exif_size, size)
    is_small, is_web_size = longer < SCALED_BELOW, longer in WEB_SIDES
    is_in_blocks = longer % NATIVE_MULTIPLES[0] == 0 and shorter % NATIVE_MULTIPLES[1] == 0
    names_size = metadata.exif_size is not None and metadata.has_camera
    if names_size and not is_changed and (is_in_blocks or not (is_small or is_web_size)):
        return False  # not after a change: programs that scale may rewrite the size in EXIF
    if metadata.file_format in FOOTAGE:
        return None
    if is_small or (is_web_size and metadata.file_format == "JPEG" and not metadata.has_camera):
        return True
    is_native = shorter * longer >= NATIVE_PIXELS and picture_shape(*size) != "other" and is_in_blocks
    return False if is_native else None


def _is_scaled_from(before: tuple[int, ...], now: tuple[int, ...]) -> bool | None:
    """Return whether a picture was scaled from another size, both (shorter, longer) side; None if it was cut."""
    ratios = now[0] / before[0], now[1] / before[1]
    if min(ratios) > 1 - SAME_SHAPE and max(ratios) <= 1:
        return None
    return True if ratios[1] > 1 or abs(ratios[0] / ratios[1] - 1) < SAME_SHAPE else None


def _words(origin: FileOrigin, metadata: FileMetadata) -> Iterator[str]:
    """Yield the words for an origin, one part of a sentence each."""
    if origin.renderer:
        yield f"rendered by {origin.renderer}"
    elif origin.camera:
        yield f"taken by {origin.camera}" + (f", {_DEVICES[origin.device]}" if origin.device else "")
    elif metadata.is_unread:
        yield "its EXIF is compressed and was not read"
    else:
        yield "the file names no camera"
    yield from filter(None, (_program_words(origin, metadata), _scaling_words(origin, metadata)))
    if metadata.is_turned:
        yield "turned upright, as the file asks"
    if origin.encoding == Encoding.MOVIE:
        yield "a frame of a movie"
    elif origin.encoding:
        yield f"{metadata.file_format} files hold {origin.encoding}"


def _program_words(origin: FileOrigin, metadata: FileMetadata) -> str:
    """Return the part of programs in words; empty if nothing is known of any, or scaling says it."""
    if origin.editor:
        names_raw = origin.is_developed and (metadata.raw_file or metadata.derived_from)
        saved = f"saved by {origin.editor}" + ", a raw developer" * origin.is_developed
        return f"developed from a raw file by {origin.editor}" if names_raw else saved
    if origin.is_resaved is False:
        size = metadata.width, metadata.height
        before = metadata.exif_size or size
        if math.prod(size) < (1 - SAME_SHAPE) * math.prod(before):
            return "cropped from {} x {} to {} x {} pixels".format(*before, *size)
        return "nothing shows that a program wrote the file"
    if not origin.is_resaved or origin.is_scaled:
        return ""
    quality = f", as JPEG of quality {origin.jpeg_quality}" if origin.jpeg_quality else ""
    return f"encoded again by a program{quality}"


def _scaling_words(origin: FileOrigin, metadata: FileMetadata) -> str:
    """Return the scaling in words; empty without any."""
    if not origin.is_scaled:
        return ""
    size, before = (metadata.width, metadata.height), metadata.exif_size
    now = "{} x {} pixels".format(*size)
    if before and sorted(before) != sorted(size):
        verb = "scaled" if max(size) > max(before) else "scaled or cropped"
        return "{} from {} x {} to {} after the camera wrote it".format(verb, *before, now)
    has_few_pixels = origin.device in (Device.SCANNER, Device.THERMAL)  # as it is
    return "" if has_few_pixels else f"probably scaled after the camera wrote it ({now})"

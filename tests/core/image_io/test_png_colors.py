"""The color tags in the chunks of PNG files, by their order in the specification's third edition."""

import struct
import zlib

import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image

from crfnet_core.colorimetry import ADOBE_RGB, DISPLAY_P3, PHOTOGRAPHIC, PROPHOTO, REC709, REC2020
from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_codes, read_photo
from crfnet_core.photograph.image_io.png_files import with_color_chunks
from crfnet_core.photograph.metadata.color_tags import PRIMARIES, ColorTags
from crfnet_core.photograph.metadata.icc import DAMAGED
from tests.helpers.color_profiles import matrix_profile
from tests.helpers.crafted_files import png, png_chunk
from tests.helpers.folders import written
from tests.helpers.refusals import refusal_of

#: A profile in Adobe RGB as PNG holds it.
ICC_CHUNK = b"a\0\0" + zlib.compress(matrix_profile(ADOBE_RGB))


def tags(path, **chunks):
    content = b"".join(png_chunk(name.encode(), content) for name, content in chunks.items())
    return read_photo(written(path, png(2, 2, bytes(14), chunks=content))).metadata.color


def chrm(primaries):
    white_last = np.rint(primaries.corners * 100_000).astype(int).ravel().tolist()
    return struct.pack(">8I", *white_last[6:], *white_last[:6])


@pytest.mark.parametrize("primaries", [*PHOTOGRAPHIC.values(), PRIMARIES[11]])
def test_named_chromaticities_are_known(tmp_path, primaries):
    assert tags(tmp_path / "a.png", cHRM=chrm(primaries)) == ColorTags(primaries, "", "cHRM chunk")


@pytest.mark.parametrize(
    ("codes", "expected"),
    [
        ((12, 13, 0, 1), ColorTags(DISPLAY_P3, "", "CICP", "CICP")),
        ((9, 16, 0, 1), ColorTags(REC2020, "PQ", "CICP", "CICP")),
        ((9, 18, 0, 1), ColorTags(REC2020, "HLG", "CICP", "CICP")),
        ((2, 2, 0, 1), ColorTags(ADOBE_RGB, "", "ICC profile", "ICC profile")),
        ((2, 18, 0, 1), ColorTags(ADOBE_RGB, "HLG", "ICC profile", "CICP")),
        ((10, 13, 0, 1), ColorTags(None, "", "CICP primaries 10", "CICP")),
    ],
)
def test_codes_come_before_the_profile(tmp_path, codes, expected):
    assert tags(tmp_path / "a.png", cICP=bytes(codes), iCCP=ICC_CHUNK) == expected


def test_chunks_are_believed_by_their_order(tmp_path):
    chunks = {"cICP": bytes([12, 13, 0, 1]), "iCCP": ICC_CHUNK, "sRGB": b"\0", "cHRM": chrm(PROPHOTO)}
    expected = [(DISPLAY_P3, "CICP"), (ADOBE_RGB, "ICC profile"), (REC709, "sRGB chunk"), (PROPHOTO, "cHRM chunk")]
    for index, (primaries, source) in enumerate(expected):
        remaining = dict([*chunks.items()][index:])
        encoding = "" if primaries is PROPHOTO else source
        assert tags(tmp_path / "a.png", **remaining) == ColorTags(primaries, "", source, encoding)


def test_an_encoding_for_displays_is_an_answer_too(tmp_path):
    chunk = b"a\0\0" + zlib.compress(matrix_profile(ADOBE_RGB, curves=[b"curv" + bytes(8)] * 3))
    assert tags(tmp_path / "a.png", cICP=bytes([1, 13, 0, 1]), iCCP=chunk) == ColorTags(REC709, "", "CICP", "CICP")


def test_a_gamma_of_one_is_linear_unless_another_chunk_knows_better(tmp_path):
    path, linear = tmp_path / "a.png", struct.pack(">I", 100_000)
    for gamma in (linear, struct.pack(">I", 99_000)):
        assert tags(path, gAMA=gamma) == ColorTags(None, "linear", "", "gAMA chunk")
    assert tags(path, gAMA=linear, cHRM=chrm(REC2020)) == ColorTags(REC2020, "linear", "cHRM chunk", "gAMA chunk")
    assert tags(path, gAMA=linear, sRGB=b"\0") == ColorTags(REC709, "", "sRGB chunk", "sRGB chunk")
    assert tags(path, gAMA=linear, cICP=bytes([9, 13, 0, 1])) == ColorTags(REC2020, "", "CICP", "CICP")
    assert tags(path, gAMA=linear, cICP=bytes([9, 2, 0, 1])) == ColorTags(REC2020, "linear", "CICP", "gAMA chunk")
    assert tags(path, gAMA=linear, iCCP=b"a\0\0damaged") == ColorTags(None, "linear", DAMAGED, "gAMA chunk")
    assert tags(path, gAMA=struct.pack(">I", 45_455)) == ColorTags()


def test_limited_range_is_refused(tmp_path):
    assert refusal_of(PhotoError, tags, tmp_path / "a.png", cICP=bytes([1, 1, 0, 0])).code == "coding_not_read"


@pytest.mark.parametrize("chunks", [{}, {"cHRM": bytes(32)}, {"cHRM": bytes(31)}, {"cICP": bytes(3)}, {"sRGB": b""}])
def test_damaged_chunks_say_nothing(tmp_path, chunks):
    assert tags(tmp_path / "a.png", **chunks) == ColorTags()


def test_a_file_that_ends_among_the_chunks_says_what_came_before(tmp_path):
    whole = png(2, 2, bytes(14), chunks=png_chunk(b"gAMA", bytes(4)) + png_chunk(b"cHRM", bytes(32)))
    header = with_color_chunks(oiio.ImageSpec(), written(tmp_path / "a.png", whole[:70]))
    assert [each.name for each in header.extra_attribs if each.name in ("png:gamma", "chromaticities")] == ["png:gamma"]


@pytest.mark.parametrize("place", ["in front", "behind"])
@pytest.mark.parametrize("name", [b"", b"Exif\0\0"])
def test_exif_turns_the_picture_wherever_it_stands(tmp_path, place, name):
    exif = Image.Exif()
    exif[0x0112], exif[0x010F], exif[0x8769] = 6, "Maker", {0x8832: 2**32 - 1}  # a number beyond int
    chunk = png_chunk(b"eXIf", name + exif.tobytes().removeprefix(b"Exif\0\0"))
    content = png(2, 2, bytes([0, 1, 1, 1, 2, 2, 2, 0, 3, 3, 3, 4, 4, 4]))
    at = content.index(b"IDAT" if place == "in front" else b"IEND") - 4
    values = read_codes(written(tmp_path / "a.png", content[:at] + chunk + content[at:]))
    assert values.codes[..., 0].tolist() == [[3, 1], [4, 2]]
    assert (values.metadata.make, values.metadata.is_turned) == ("Maker", True)


def test_a_profile_that_libpng_rejects_is_read(tmp_path):
    """Its length is not a multiple of four."""
    linear = matrix_profile(REC709, curves=[b"curv" + struct.pack(">II", 0, 0)] * 3)
    content = struct.pack(">I", len(linear) + 1) + linear[4:] + b"\0"
    chunk = b"a\0\0" + zlib.compress(content)
    assert tags(tmp_path / "a.png", iCCP=chunk) == ColorTags(REC709, "linear", "ICC profile", "ICC profile")
    assert tags(tmp_path / "a.png", iCCP=b"a\0\0damaged") == ColorTags(source=DAMAGED)


def test_texts_named_like_attributes_change_nothing(tmp_path):
    texts = {b"oiio:BitsPerSample": b"3", b"Orientation": b"6", b"png:palette": b"1", b"png:sRGB": b"0"}
    texts |= {b"dpx:Transfer": b"Logarithmic", b"colorInteropID": b"lin_ap1_scene"}
    chunks = b"".join(png_chunk(b"tEXt", name + b"\0" + value) for name, value in texts.items())
    values = read_codes(written(tmp_path / "a.png", png(2, 2, bytes(14), chunks=chunks)))
    assert (values.bit_depth, values.metadata.is_turned, values.metadata.color) == (8, False, ColorTags())

import numpy as np
import pytest
from PIL import Image

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_metadata, read_photo
from crfnet_core.photograph.metadata import file_origin
from crfnet_core.photograph.metadata.jpeg import (
    ANNEX_K_CHROMA,
    ANNEX_K_LUMA,
    ijg_quality,
    read_jpeg_header,
    scaled_table,
)
from crfnet_core.photograph.metadata.origin import ADOBE
from tests.helpers.crafted_files import camera_jpeg, jpeg, with_jpeg_segment, xmp_packet
from tests.helpers.folders import written
from tests.helpers.images import write_image
from tests.helpers.refusals import refusal_of

EXIF: dict[str, object] = {"Make": "Canon", "Model": "Canon EOS 20D", "Software": "Adobe Photoshop CS6"}
EXIF |= {"Exif__PhotographicSensitivity": 200, "Exif__PixelXDimension": 3504, "Exif__PixelYDimension": 2336}
OWN_TABLE, PHOTOSHOP = (3,) * 64, "Adobe Photoshop CC (Macintosh)"


def read(path):
    return read_photo(path).metadata


@pytest.mark.parametrize("name", ["a.jpg", "a.png", "a.tif"])
def test_exif_is_read(tmp_path, name):
    metadata = read(write_image(tmp_path / name, np.zeros((16, 24, 3), np.uint8), **EXIF))
    assert (metadata.width, metadata.height) == (24, 16)
    assert (metadata.make, metadata.model, metadata.software) == ("Canon", "Canon EOS 20D", "Adobe Photoshop CS6")
    assert metadata.exif_size == (3504, 2336)
    assert metadata.file_format == {"a.jpg": "JPEG", "a.png": "PNG", "a.tif": "TIFF"}[name]


@pytest.mark.parametrize(("quality", "subsampling"), [(1, "4:4:4"), (25, "4:2:2"), (50, "4:4:4"), (100, "4:2:0")])
def test_tables_of_the_ijg_library(tmp_path, quality, subsampling):
    jpeg(tmp_path / "a.jpg", Compression=f"jpeg:{quality}", jpeg__subsampling=subsampling)
    metadata = read(tmp_path / "a.jpg")
    assert metadata.luma_table == scaled_table(ANNEX_K_LUMA, quality)
    assert metadata.chroma_table == scaled_table(ANNEX_K_CHROMA, quality)
    assert metadata.has_jfif
    assert file_origin(metadata).jpeg_quality == quality


def test_a_gray_jpeg_has_one_table(tmp_path):
    metadata = read(write_image(tmp_path / "a.jpg", np.zeros((16, 16, 1), np.uint8), Compression="jpeg:80"))
    assert (metadata.chroma_table, file_origin(metadata).jpeg_quality) == ((), 80)


def test_a_jpeg_as_a_camera_writes_it(tmp_path):
    size = {"Exif__PixelXDimension": 160, "Exif__PixelYDimension": 120}
    camera_jpeg(tmp_path / "a.jpg", **EXIF | size | {"Software": "Ver.1.00"})
    metadata = read(tmp_path / "a.jpg")
    assert not metadata.has_jfif
    assert (metadata.luma_table, metadata.iso) == (OWN_TABLE, 200)
    origin = file_origin(metadata)
    assert (origin.is_resaved, origin.is_scaled, origin.jpeg_quality) == (False, False, None)
    assert origin.words == (
        "taken by Canon EOS 20D, a camera with interchangeable lenses",
        "nothing shows that a program wrote the file",
    )


def test_adobes_segment_names_an_editor_where_no_text_does(tmp_path):
    content = jpeg(tmp_path / "a.jpg")
    path = written(tmp_path / "a.jpg", with_jpeg_segment(content, 0xEE, b"Adobe\0\x64\0\0\0\0\x01"))
    assert file_origin(read(path)).editor == ADOBE


@pytest.mark.parametrize(
    ("changed", "programs"), [(["/"], (PHOTOSHOP,)), (["/metadata"], ()), (["/", "/metadata"], (PHOTOSHOP,))]
)
def test_xmp_names_programs_that_saved_pixels_and_the_raw_file(tmp_path, changed, programs):
    xmp = (
        b'http://ns.adobe.com/xap/1.0/\0<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf='
        b'"http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description xmlns:xmpMM="http://ns.adobe.com/xap/1.0/mm/"'
        b' xmlns:stEvt="http://ns.adobe.com/xap/1.0/sType/ResourceEvent#" crs:RawFileName="_DSC0001.NEF"'
        b' xmlns:crs="http://ns.adobe.com/camera-raw-settings/1.0/"><xmpMM:History><rdf:Seq>'
        b"%b</rdf:Seq></xmpMM:History></rdf:Description></rdf:RDF></x:xmpmeta>"
    )
    event = '<rdf:li stEvt:action="saved" stEvt:softwareAgent="{}" stEvt:changed="{}"/>'
    xmp %= "".join(map(event.format, (PHOTOSHOP, "Adobe Photoshop Lightroom 6"), changed)).encode()
    content = jpeg(tmp_path / "a.jpg", Software="Ver.1.0")
    metadata = read(written(tmp_path / "a.jpg", with_jpeg_segment(content, 0xE1, xmp)))
    assert (metadata.history, metadata.raw_file) == (programs, "_DSC0001.NEF")
    assert file_origin(metadata).editor == (programs or (ADOBE,))[0]
    assert file_origin(metadata).is_developed


@pytest.mark.parametrize("name", ["a.jpg", "a.webp", "a.tif"])
def test_the_first_program_does_not_hide_the_last(tmp_path, name):
    """OpenImageIO gives the name of EXIF Software to XMP's CreatorTool, which cameras write, too."""
    exif, camera = Image.Exif(), "NIKON Z 6_2 Ver.01.60"
    exif[305] = "GIMP 2.10.34"
    xmp = xmp_packet(b'xmlns:xmp="http://ns.adobe.com/xap/1.0/" xmp:CreatorTool="%b"' % camera.encode())
    tags = {"tiffinfo": {305: exif[305], 700: xmp}} if name == "a.tif" else {"exif": exif, "xmp": xmp}
    Image.new("RGB", (24, 16)).save(tmp_path / name, **tags)
    metadata = read(tmp_path / name)
    assert (metadata.software, metadata.history) == (exif[305], (camera,))
    assert file_origin(metadata).editor == exif[305]


@pytest.mark.parametrize(("is_applied", "raw_file"), [("True", "1.NEF"), ("False", "")])
def test_settings_that_are_not_applied_have_developed_nothing(tmp_path, is_applied, raw_file):
    settings = (
        b'xmlns:crs="http://ns.adobe.com/camera-raw-settings/1.0/" crs:RawFileName="1.NEF" crs:AlreadyApplied="%b"'
    )
    Image.new("RGB", (24, 16)).save(tmp_path / "a.jpg", xmp=xmp_packet(settings % is_applied.encode()))
    assert read(tmp_path / "a.jpg").raw_file == raw_file


@pytest.mark.parametrize(
    "content", [b"", b"\xff\xd8", b"\xff\xd8\xff\xdb\0\x05\x00\x01\x02", b"\xff\xd8\xff\xc0\0\x04\x08\0"]
)
def test_damaged_segments_leave_fields_empty(content):
    header = read_jpeg_header(content)
    assert (header.luma_table, header.chroma_table) == ((), ())


def test_other_tables_have_no_quality_of_the_ijg_library():
    mixed = scaled_table(ANNEX_K_LUMA, 90), scaled_table(ANNEX_K_CHROMA, 80)
    assert [ijg_quality(*tables) for tables in ([()], [OWN_TABLE], mixed)] == [None] * 3


def test_metadata_alone_is_read_without_the_pixels(tmp_path):
    noise = np.random.default_rng(0).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    path = write_image(tmp_path / "a.png", noise, Make="Canon")
    path.write_bytes(path.read_bytes()[:-4000])
    assert read_metadata(path).make == "Canon"
    assert refusal_of(PhotoError, read_photo, path).code == "damaged"

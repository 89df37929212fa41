from crfnet_core.photograph.metadata import file_origin
from crfnet_core.photograph.metadata.jpeg import read_jpeg_header
from tests.helpers.crafted_files import jpeg
from training.data.real.file_origin import metadata_of_case

ROW = {
    "exif_make": "NIKON CORPORATION",
    "exif_model": "NIKON D90",
    "exif_software": "Ver.1.00 ",
    "iso": "400.0",
    "original_size": "2144x1424",
    "file": "photos/nikon_d90_1a.webp",
}


def test_what_the_list_says():
    metadata = metadata_of_case(ROW)
    assert (metadata.make, metadata.model, metadata.software) == ("NIKON CORPORATION", "NIKON D90", "Ver.1.00")
    assert (metadata.width, metadata.height, metadata.iso) == (2144, 1424, 400)
    assert file_origin(metadata).device == "camera"


def test_the_crop_has_the_tables(tmp_path):
    crop = jpeg(tmp_path / "a.jpg", Compression="jpeg:90")
    metadata = metadata_of_case(ROW, crop)
    assert metadata.luma_table == read_jpeg_header(crop).luma_table
    assert not metadata.has_jfif


def test_fields_may_be_empty():
    metadata = metadata_of_case(ROW | {"exif_make": "", "exif_model": "", "exif_software": "", "iso": ""})
    assert not metadata.has_camera
    assert metadata.iso is None

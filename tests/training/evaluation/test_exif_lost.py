"""P4 as web sites send photographs: without EXIF."""

from dataclasses import replace

import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")

from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.metadata import FileMetadata
from training.evaluation.measure.real import without_exif


def test_a_file_that_lost_its_exif_keeps_the_size_of_its_picture_only(root):
    taken = FileMetadata(width=6000, height=4000, make="Canon", model="Canon EOS 6D", software="Adobe Photoshop")
    photo = replace(read_photo(root / "tests" / "data" / "plate.jpg"), metadata=taken)
    height, width = photo.pixels.shape[:2]
    assert without_exif(photo).metadata == FileMetadata(width=width, height=height, file_format="WebP")
    assert without_exif(photo).pixels is photo.pixels

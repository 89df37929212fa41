from pathlib import Path

import numpy as np
import pytest

from crfnet_core.photograph.metadata import FileMetadata, file_origin
from crfnet_core.photograph.metadata.jpeg import read_jpeg_header
from crfnet_core.response.curve import UNIFORM
from tests.helpers.crafted_files import jpeg
from training.data import real_photographs as module
from training.data.real_photographs import RealPhotograph, measured_bodies, metadata_of_case

ROW = {
    "exif_make": "NIKON CORPORATION",
    "exif_model": "NIKON D90",
    "exif_software": "Ver.1.00 ",
    "iso": "400.0",
    "original_size": "2144x1424",
    "file": "photos/nikon_d90_1a.webp",
}


def photograph(folder, name, body, fold, *, stack="1", kind="camera", raw_file=""):
    """A photograph of DATA/real or DATA/real_bodies, without pixels."""
    measured = folder / "gt" / f"{body}{stack}.csv"
    measured.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(measured, np.stack([UNIFORM, UNIFORM**0.45], axis=1), delimiter=",", header="e,b")
    path = folder / "photos" / f"{name}.jpg"
    metadata = FileMetadata(raw_file=raw_file)
    return RealPhotograph(name, body, kind, "A", "", True, fold, path, measured, metadata)


@pytest.fixture
def photographs(tmp_path, monkeypatch):
    """Two folders that share a model; DATA/real separates two of its bodies in brackets."""
    real, more = tmp_path / "real", tmp_path / "real_bodies"
    sets = {
        "real": [
            photograph(real, "r1", "Nikon D90", "Nikon D90"),
            photograph(real, "r2", "Nikon D90 (second body)", "Nikon D90 (second body)"),
            photograph(real, "r3", "Canon S45", "Canon S45", kind="compact"),
        ],
        "real_bodies": [
            photograph(more, "b1", "NIKON D90", "0"),
            photograph(more, "b2", "NIKON D90", "0", stack="2"),
            photograph(more, "b3", "NIKON D90", "0", stack="2"),
            photograph(more, "b4", "Pixel 3", "0", kind="phone"),
            photograph(more, "b5", "Pixel 4", "1", kind="phone"),
        ],
    }
    monkeypatch.setattr(module, "real_photographs", lambda data: sets)
    return sets


def keys(**options):
    return [body.key for body in measured_bodies(Path(), **options)]


def test_a_body_has_one_response_for_each_stack(photographs):
    found = {body.key: body for body in measured_bodies(Path())}
    assert list(found) == ["canon s45", "nikon d90", "nikon d90 (second body)", "pixel 3", "pixel 4"]
    assert [len(body.responses) for body in found.values()] == [1, 3, 1, 1, 1]
    assert found["pixel 3"].kind == "phone"


def test_a_fold_is_left_out_with_all_bodies_of_its_models(photographs):
    """The camera of the fold is in the other folder too, once as another body."""
    assert keys(without="0") == ["canon s45", "pixel 4"]
    assert keys(without="Nikon D90 (second body)") == ["canon s45", "pixel 3", "pixel 4"]


def test_what_a_program_developed_is_no_response_of_the_camera(photographs, tmp_path):
    photographs["real"].append(photograph(tmp_path / "real", "r4", "Nikon D800", "Nikon D800", raw_file="1.NEF"))
    photographs["real"].append(photograph(tmp_path / "real", "r5", "Nikon D700", "Nikon D700", raw_file="1.jpg"))
    assert "nikon d700" in keys()
    assert "nikon d800" not in keys()


def test_the_list_keeps_the_metadata_of_the_original_file():
    metadata = metadata_of_case(ROW)
    assert (metadata.make, metadata.model, metadata.software) == ("NIKON CORPORATION", "NIKON D90", "Ver.1.00")
    assert (metadata.width, metadata.height, metadata.iso) == (2144, 1424, 400)
    assert file_origin(metadata).device == "camera"


def test_the_crop_has_the_tables_of_the_original_file(tmp_path):
    crop = jpeg(tmp_path / "a.jpg", Compression="jpeg:90")
    metadata = metadata_of_case(ROW, crop)
    assert metadata.luma_table == read_jpeg_header(crop).luma_table
    assert not metadata.has_jfif


def test_fields_of_the_list_may_be_empty():
    metadata = metadata_of_case(ROW | {"exif_make": "", "exif_model": "", "exif_software": "", "iso": ""})
    assert not metadata.has_camera
    assert metadata.iso is None

import struct

import pytest

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.image_io.heif_items import decoded_pixels
from crfnet_core.photograph.image_io.iso_boxes import MOST_META, find_box
from tests.helpers.crafted_files import box
from tests.helpers.folders import written
from tests.helpers.refusals import refusal_of


def full(kind, *parts):
    """A box of version 0 without flags."""
    return box(kind, bytes(4), *parts)


def numbers(*values):
    return struct.pack(f">{len(values)}H", *values)


def heif(path, references, side=8192, before=b""):
    """Write the items that are referred to, each square, without any picture."""
    items = sorted({*references, *(other for others in references.values() for other in others)})
    size = full(b"ispe", struct.pack(">II", side, side))
    owners = struct.pack(">I", len(items)) + b"".join(numbers(item) + b"\1\1" for item in items)
    entries = [box(b"dimg", numbers(item, len(others), *others)) for item, others in references.items()]
    properties = box(b"iprp", box(b"ipco", size), full(b"ipma", owners))
    start = box(b"ftyp", b"heic", bytes(4), b"mif1")
    return written(path, start + before + full(b"meta", properties, full(b"iref", *entries)))


def test_an_item_counts_as_often_as_it_is_decoded(tmp_path):
    tiles = range(4, 14)
    path = heif(tmp_path / "a.heic", {1: [2, 3], 2: tiles, 3: tiles}, side=10, before=box(b"free", bytes(2**21)))
    assert decoded_pixels(find_box(path, b"meta")) == 100 * (1 + 2 + 2 * 10)


@pytest.mark.parametrize(
    "references",
    [{1: range(2, 900)}, {1: [1]}, {1: [2], 2: [1]}, {item: [item + 1] for item in range(1, 20)}],
    ids=["tiles", "itself", "circle", "chain"],
)
def test_a_heif_file_that_would_be_decoded_for_minutes_is_refused(tmp_path, monkeypatch, references):
    monkeypatch.setattr("pi_heif.open_heif", None)
    assert refusal_of(PhotoError, read_photo, heif(tmp_path / "a.heic", references)).code == "damaged"


@pytest.mark.parametrize("before", [box(b"free") * 2000, struct.pack(">I", MOST_META + 1) + b"meta"])
def test_items_that_stand_where_no_writer_puts_them_are_refused(tmp_path, before):
    with pytest.raises(ValueError, match="not found"):
        find_box(heif(tmp_path / "a.heic", {1: [2]}, before=before), b"meta")


def test_names_that_are_not_text_are_found_behind_a_long_box(root, tmp_path):
    """pi-heif ends the process at them."""
    content = (root / "tests" / "data" / "heif" / "full8.heic").read_bytes().replace(b"hvc1", b"\xff\xff\xff\xff", 1)
    size = int.from_bytes(content[:4])
    path = written(tmp_path / "a.heic", content[:size] + box(b"free", bytes(2**21)) + content[size:])
    assert refusal_of(PhotoError, read_photo, path).code == "damaged"

import csv
import json

import pytest

from training.data.curves import BASE_CURVES_FILE, DORF_FILE, EMOR_FILE
from training.data.manifest import (
    MANIFEST_FILE,
    NO_LICENCE,
    ManifestRow,
    differences,
    main,
    manifest_rows,
    read_manifest,
)
from training.data.splits import SPLITS_FILE


def write_table(path, rows):
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


@pytest.fixture
def data(tmp_path):
    """A data folder: three curve files, forty scenes, a real photograph and one with a fold, both with responses."""
    folder = tmp_path / "data"
    scenes = [
        {"file": f"pano{n:02d}.exr", "kind": "panorama band", "source": f"somewhere:{n}", "licence": "CC0"}
        for n in range(40)
    ]
    write_table(folder / "linear" / "manifest.csv", scenes)
    real = {"id": "one", "licence": "none stated in repository", "source_repo": "a/b", "source_input": "c.jpg"}
    write_table(folder / "real" / "cases.csv", [real | {"input_file": "input/one.jpg"}])
    body = {"id": "two", "licence": "MIT (LICENSE)", "source_repo": "a/d", "source_dir": "e", "fold": "3"}
    body |= {"file": "photos/two.webp", "crop": "", "gt": "gt/two.csv"}
    write_table(folder / "real_bodies" / "cases.csv", [body])
    names = [DORF_FILE, BASE_CURVES_FILE, EMOR_FILE, *(f"linear/{scene['file']}" for scene in scenes)]
    names += ["real/input/one.jpg", "real/gt/one.csv", "real_bodies/photos/two.webp", "real_bodies/gt/two.csv"]
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(name)
    return folder


@pytest.fixture
def written(data, tmp_path):
    path = tmp_path / "manifest.csv"
    assert main(["--data", str(data), "--manifest", str(path)]) == 0
    return path


def test_every_file_has_a_row_and_rows_are_sorted(data, written):
    rows = read_manifest(written)
    assert len(rows) == 3 + 3 + 40 + 2 + 2
    assert rows == sorted(rows) == manifest_rows(data)
    assert str(data) not in written.read_text()
    by_file = {row.file: row for row in rows}
    name, sha256 = "real/input/one.jpg", "60a5827806738f73207efeb1f332e69846ed6dd9455546dc23c9f0b8a7777778"
    row = ManifestRow(name, "real photograph", "a/b:c.jpg", NO_LICENCE, "measured only", sha256)
    assert by_file[name] == row
    assert by_file["real_bodies/photos/two.webp"].split == "measured only, fold 3"
    assert by_file["real_bodies/cases.csv"].split == "decides grade, fold and use"
    assert by_file["real_bodies/photos/two.webp"].licence == "MIT (LICENSE)"


def test_the_check_passes_on_the_data_that_was_listed(data, written, capsys):
    assert main(["--data", str(data), "--manifest", str(written), "--check"]) == 0
    assert capsys.readouterr().out.endswith("as manifest.csv says\n")


def test_the_check_lists_what_is_absent_altered_and_unlisted(data, written, capsys):
    (data / "linear" / "pano00.exr").unlink()
    (data / "linear" / "pano01.exr").write_text("another")
    (data / "real" / "input" / "new.jpg").write_text("new")
    assert main(["--data", str(data), "--manifest", str(written), "--check"]) == 2
    lines = ["absent: linear/pano00.exr", "altered: linear/pano01.exr", "unlisted: real/input/new.jpg"]
    assert capsys.readouterr().out.splitlines()[-3:] == lines == differences(data, read_manifest(written))


def test_an_absent_file_of_a_table_is_named(data, tmp_path, capsys):
    (data / "linear" / "pano00.exr").unlink()
    assert main(["--data", str(data), "--manifest", str(tmp_path / "new.csv")]) == 2
    assert "pano00.exr: is absent" in capsys.readouterr().err
    assert not (tmp_path / "new.csv").exists()


def test_the_committed_manifest_splits_the_scenes_as_splits_json():
    listed = {"train": set(), "validation": set(), "test": set()}
    for row in read_manifest():
        if row.kind == "scene":
            listed[row.split].add(row.file.removeprefix("linear/"))
    splits = json.loads(SPLITS_FILE.read_text())["scenes"]
    assert listed == {split: set(scenes) for split, scenes in splits.items()}


def test_the_scenes_of_the_paper_s_network_are_listed_with_source_licence_and_hash():
    rows = read_manifest(MANIFEST_FILE.with_name("manifest_crfnet2017.csv"))
    assert len({row.sha256 for row in rows}) == 66
    assert all(row.source and row.licence and len(row.sha256) == 64 for row in rows)
    assert not {row.file for row in read_manifest()} & {row.file for row in rows}

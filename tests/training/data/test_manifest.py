import hashlib

import pytest

from training.data import manifest
from training.data.curves import BASE_CURVES_FILE, DORF_FILE
from training.data.manifest import MANIFEST_FILE, ManifestRow, main, read_manifest, training_digest
from training.data.splits import SPLITS


@pytest.fixture
def data(tmp_path, monkeypatch):
    """A data folder of two files of curves and two scenes, one of them imported, and its manifest."""
    files = {DORF_FILE: "responses", BASE_CURVES_FILE: "responses", "linear/Tree.exr": "scene"}
    for name in (*files, "linear/mine.exr"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(name)
    table = "file,kind,source,licence\nTree.exr,photograph,where,CC0\nmine.exr,photograph,imported: mine.dng,CC0\n"
    (tmp_path / "linear" / "manifest.csv").write_text(table)
    rows = [row_of(name, kind) for name, kind in files.items()]
    monkeypatch.setattr(manifest, "read_manifest", lambda: rows)
    return tmp_path


def row_of(name, kind, source="where"):
    return ManifestRow(name, kind, source, "CC0", "train", hashlib.sha256(name.encode()).hexdigest())


def test_the_check_lists_what_is_absent_altered_and_unlisted(data, capsys):
    (data / DORF_FILE).unlink()
    (data / "linear" / "Tree.exr").write_text("another")
    assert main(["--data", str(data)]) == 2
    lines = [f"absent: {DORF_FILE}", "altered: linear/Tree.exr"]
    lines += ["unlisted: linear/manifest.csv", "unlisted: linear/mine.exr"]
    assert capsys.readouterr().out.splitlines() == lines


def test_the_check_passes_on_the_data_that_is_listed(data, capsys):
    for name in ("mine.exr", "manifest.csv"):
        (data / "linear" / name).unlink()
    assert main(["--data", str(data)]) == 0
    assert capsys.readouterr().out.endswith("as manifest.csv says\n")


def test_the_digest_of_a_training_is_of_the_curves_and_of_all_scenes_as_they_are(data):
    rows = [row_of(BASE_CURVES_FILE, "responses"), row_of(DORF_FILE, "responses"), row_of("linear/Tree.exr", "scene")]
    rows.append(row_of("linear/mine.exr", "scene", "imported: mine.dng"))
    lines = ["file,kind,source,licence,split,sha256", *(",".join(vars(row).values()) for row in rows), ""]
    assert training_digest(data) == hashlib.sha256("\n".join(lines).encode()).hexdigest()
    (data / "linear" / "mine.exr").write_text("another")
    assert training_digest(data) != hashlib.sha256("\n".join(lines).encode()).hexdigest()


def test_the_committed_manifest_splits_the_scenes_as_splits_json():
    listed = {"train": set(), "validation": set(), "test": set()}
    for row in read_manifest():
        if row.kind == "scene":
            listed[row.split].add(row.file.removeprefix("linear/"))
    assert listed == {split: set(scenes) for split, scenes in SPLITS["scenes"].items()}


def test_the_scenes_of_the_paper_s_network_are_listed_with_source_licence_and_hash():
    rows = read_manifest(MANIFEST_FILE.with_name("manifest_crfnet2017.csv"))
    assert len({row.sha256 for row in rows}) == 66
    assert all(row.source and row.licence and len(row.sha256) == 64 for row in rows)
    assert not {row.file for row in read_manifest()} & {row.file for row in rows}

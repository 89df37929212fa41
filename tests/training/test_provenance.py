import json

import pytest

pytest.importorskip("torch", reason="training needs the train extra")

from crfnet_core.network import MODELS, ModelConfig
from training.provenance import data_record, read_run, record_making, record_run, training_commit

RECIPE = {"epochs": 3, "sizes": {"width": 8}}


@pytest.fixture
def shards(tmp_path):
    for name in ("a", "b"):
        (tmp_path / f"{name}.npz").write_text(name)
    record_making(tmp_path, "train", "0" * 64)
    return tmp_path


def record(shards, **changes):
    entries = {"recipe": RECIPE, "seed": 1, "start": "random weights"} | changes
    return record_run(shards / "run", data=data_record(shards, shards.glob("*.npz")), **entries)


def test_a_run_records_code_data_recipe_and_versions(shards):
    entries = record(shards)
    assert entries == read_run(shards / "run") == json.loads((shards / "run" / "run.json").read_text())
    assert (entries["recipe"], entries["seed"], entries["start"]) == (RECIPE, 1, "random weights")
    assert set(entries["versions"]) == {"python", "torch", "numpy"}
    assert entries["command"][0] == "python"
    assert entries["data"]["files"] == 2
    assert entries["data"]["made"]["train"][0]["source_sha256"] == "0" * 64
    assert entries["resumed"] == []


def test_a_run_that_goes_on_keeps_its_record_and_adds_the_resumption(shards):
    first = record(shards)
    again = record(shards)
    assert len(again["resumed"]) == 1
    assert again | {"resumed": []} == first


@pytest.mark.parametrize(
    ("changes", "named"),
    [({"seed": 2}, "seed"), ({"recipe": {**RECIPE, "epochs": 4}}, "epochs"), ({"start": "x"}, "start")],
)
def test_a_run_of_another_recipe_is_refused(shards, changes, named):
    record(shards)
    with pytest.raises(SystemExit, match=f"holds a run of another {named}"):
        record(shards, **changes)


def test_a_run_on_other_data_is_refused(shards):
    record(shards)
    (shards / "a.npz").write_text("altered")
    with pytest.raises(SystemExit, match="holds a run of another data"):
        record(shards)


def test_the_packaged_models_carry_a_record_that_agrees_with_model_json():
    for folder in sorted(path.parent for path in MODELS.glob("*/model.json")):
        entries = read_run(folder)
        assert training_commit(entries) == ModelConfig.read(folder / "model.json").training_commit
        assert {"recorded", "command", "versions", "seed", "start", "recipe", "data", "resumed"} <= set(entries)
        assert f"## {folder.name} - " in (MODELS / "CHANGELOG.md").read_text()

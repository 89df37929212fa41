import json

import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")

from training.network.average import average

RECORD = {
    "commit": "0" * 40,
    "start": "start.pt",
    "recipe": {"network": {"width": 2}},
    "data": {"files": 1, "sha256": "a"},
}


def run_of(folder, weight, **changed):
    folder.mkdir()
    torch.save({"network": {"weight": torch.tensor([weight]), "batches": torch.tensor(7)}}, folder / "last.pt")
    (folder / "run.json").write_text(json.dumps(RECORD | changed))
    return folder


def test_the_mean_counts_each_run_by_its_share(tmp_path):
    runs = [run_of(tmp_path / "a", 1.0), run_of(tmp_path / "b", 5.0, commit="1" * 40)]
    checkpoint = average(runs, [1, 3], tmp_path / "mean")
    net = torch.load(checkpoint, weights_only=True)["network"]
    assert net["weight"].tolist() == [4.0]
    assert net["batches"].item() == 7
    record = json.loads((tmp_path / "mean" / "run.json").read_text())
    assert record["commit"] == "1" * 40
    assert [(part["share"], part["commit"][0]) for part in record["average"]] == [(0.25, "0"), (0.75, "1")]


@pytest.mark.parametrize("changed", [{"start": "random weights"}, {"recipe": {"network": {"width": 3}}}])
def test_runs_of_different_origin_are_refused(tmp_path, changed):
    runs = [run_of(tmp_path / "a", 1.0), run_of(tmp_path / "b", 5.0, **changed)]
    with pytest.raises(SystemExit, match="cannot be averaged"):
        average(runs, [1, 1], tmp_path / "mean")
    assert not (tmp_path / "mean").exists()


@pytest.mark.parametrize("shares", [[1], [1, 0]])
def test_every_run_has_a_share(tmp_path, shares):
    runs = [run_of(tmp_path / "a", 1.0), run_of(tmp_path / "b", 5.0)]
    with pytest.raises(SystemExit, match="share above 0"):
        average(runs, shares, tmp_path / "mean")

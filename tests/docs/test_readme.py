import json
import re
import shutil

import pytest

from crfnet_core.network import DEFAULT_MODEL

MOST_WORDS = 600

#: E_est of a response that is off by the whole range of brightness: the root of 1024 samples.
FULL_RANGE = 32


@pytest.fixture(scope="module")
def readme(root):
    return (root / "README.md").read_text(encoding="utf-8")


def test_it_is_short_and_begins_with_the_installation(readme):
    assert len(readme.split()) <= MOST_WORDS
    assert re.findall(r"^## (.*)", readme, re.MULTILINE)[0] == "Install"
    assert "10.1145/3150165.3150170" in readme.partition("## ")[0]


def test_its_snippet_runs(readme, plate, tmp_path, monkeypatch):
    (snippet,) = re.findall(r"^```python\n(.*?)^```", readme, re.MULTILINE | re.DOTALL)
    assert len(snippet.strip().splitlines()) == 4  # one is empty
    shutil.copyfile(plate, tmp_path / "plate01.jpg")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(snippet, names)
    assert names["linear"].shape == (378, 672, 3)


def test_its_figures_are_those_of_the_model(readme):
    accuracy = json.loads((DEFAULT_MODEL / "model.json").read_text(encoding="utf-8"))["accuracy"]["P4 both"]
    shape, curve = (
        [accuracy[f"{name} {entry}"] for entry in ("mean", "mean of the other bodies", "gamma 2.2")]
        for name in ("shape", "E_est")
    )
    stops = " | ".join(f"{value:.2f} stop" for value in shape)
    row = f"| {accuracy['photographs']} photographs of {accuracy['bodies']} cameras never seen | {stops} |"
    assert row in readme
    text = " ".join(readme.split())
    percent = [f"{100 * value / FULL_RANGE:.1f} %" for value in curve]
    assert "curve {} of the range, average camera {}, gamma {})".format(*percent) in text

"""The README is short, its snippet runs, and its figures are those of the model card."""

import json
import re
import shutil

import pytest

from crfnet_core.network import DEFAULT_MODEL

MOST_WORDS = 700

#: E_est of a response that is off by the whole range of brightness: the root of 1024 samples.
FULL_RANGE = 32

#: What holds digits but is no measured figure.
NO_FIGURES = re.compile(r"`[^`]*`|\]\([^)]*\)|gamma 2\.2|\bP\d\b|\d+ % (?:band|intervals?)\b")


@pytest.fixture(scope="module")
def readme(root):
    return (root / "README.md").read_text(encoding="utf-8")


def accuracy_section(readme):
    return re.search(r"^## Accuracy\n(.*?)^## ", readme, re.MULTILINE | re.DOTALL)[1]


def figures(line):
    """The figures of a line: number, number of decimals, and unit ("%", "stops" or "")."""
    found = re.findall(r"(-?\d+(?:\.(\d+))?)(?: (%|stops?))?", NO_FIGURES.sub("", line))
    return [(float(number), len(decimals), unit.rstrip("s")) for number, decimals, unit in found]


def leaves(entries, name=""):
    """Every number in nested entries with its name."""
    for key, value in entries.items():
        if isinstance(value, dict):
            yield from leaves(value, key)
        elif isinstance(value, int | float):
            yield key, float(value)


def values(accuracy, unit):
    """What may be printed with a unit: percent = 100 * E_est / 32, or 100 * a fraction; stops = a shape error."""
    for name, value in leaves(accuracy):
        if unit == "stop" and name.startswith("shape"):
            yield value
        elif unit == "%" and re.match(r"(E_est|uncertainty) (?!ratio|win|rank)", name):
            yield 100 * value / FULL_RANGE
        elif unit == "%" and re.search(r"win rate|coverage|accepted", name):
            yield 100 * value
        elif not unit:
            yield value


def unknown_figures(section, accuracy):
    """The figures that are not in the accuracy of model.json; in a line that names protocols, in that of these."""
    unknown = []
    for line in section.splitlines():
        named = {name: part for name, part in accuracy.items() if re.search(rf"\b{re.escape(name)}\b", line)}
        for number, decimals, unit in figures(line):
            known = {round(value, decimals) for value in values(named or accuracy, unit)}
            if number not in known:
                unknown.append((number, unit, line))
    return unknown


def test_it_has_at_most_700_words(readme):
    assert len(readme.split()) <= MOST_WORDS


def test_its_snippet_runs(readme, plate, tmp_path, monkeypatch, capsys):
    snippets = re.findall(r"^```python\n(.*?)^```", readme, re.MULTILINE | re.DOTALL)
    assert len(snippets) == 1
    shutil.copyfile(plate, tmp_path / "plate01.jpg")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(snippets[0], names)
    assert names["linear"].shape == (378, 672, 3)
    assert capsys.readouterr().out.strip()


def test_its_figures_are_those_of_the_model(readme):
    accuracy = json.loads((DEFAULT_MODEL / "model.json").read_text(encoding="utf-8"))["accuracy"]
    section = accuracy_section(readme)
    assert sum(len(figures(line)) for line in section.splitlines()) >= 7
    assert not unknown_figures(section, accuracy)


def test_a_figure_that_is_not_the_model_s_is_found_out():
    accuracy = {"P0": {"E_est mean": 1.6, "E_est win rate": 0.85}, "P4": {"E_est mean": 3.2, "shape error mean": 0.25}}
    good = "P0 is off by 5.0 %, better in 85 %\nP4: E_est 3.2, 10 %, 0.25 stops; gamma 2.2 `0.3`"
    assert not unknown_figures(good, accuracy)
    wrong = "P0 is off by 10 %\nP4: 3.3, 85 %, 0.3 stops"
    assert [number for number, _, _ in unknown_figures(wrong, accuracy)] == [10, 3.3, 85, 0.3]


def test_the_first_finding_is_the_unpleasant_one(readme):
    first = accuracy_section(readme).strip().splitlines()[0]
    assert "uncertainty of a single real photograph is not known" in first


def test_blender_comes_first(readme):
    heads = re.findall(r"^## (.*)", readme, re.MULTILINE)
    assert heads[:3] == ["Blender", "Command", "Python"]

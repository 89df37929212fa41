import dataclasses
import importlib
import inspect
import re
import shutil
from functools import partial

import numpy as np
import pytest

import crfnet
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import Lut1D
from crfnet.options import EstimateOptions, PlateOptions
from crfnet.pipeline import LinearBatch, estimate_files, photograph_sources, run_batch
from crfnet_core.photograph.metadata import FileMetadata

#: The head of a table of names that one module has.
HEAD = re.compile(r"^\| `((?:crfnet_core|crfnet)[\w.]*)` \|")

#: A name, with its parameters if it is called.
ENTRY = re.compile(r"`([A-Za-z_.\d]+)(\(.*?\))?`(?=,| \|)")


@pytest.fixture(scope="module")
def page(root):
    return (root / "docs" / "API.md").read_text(encoding="utf-8")


def documented(page):
    """The module, the name and the parameters, or None, of each entry of the tables."""
    entries, module = [], None
    for line in page.splitlines():
        head = HEAD.match(line)
        module = head[1] if head else module if line.startswith("|") else None
        if module and not head:
            entries += [(module, *entry) for entry in ENTRY.findall(line.split(" | ")[0] + " |")]
    return entries


def named(module, name):
    """What a dotted name of a module stands for; of a field of a dataclass, the field."""
    value = importlib.import_module(module)
    for part in name.split("."):
        fields = {field.name: field for field in dataclasses.fields(value)} if dataclasses.is_dataclass(value) else {}
        value = fields[part] if part in fields else getattr(value, part)
    return value


def signature(value):
    """Parameters as the page writes them: without types, and without self."""
    parameters = [
        parameter.replace(annotation=inspect.Parameter.empty)
        for name, parameter in inspect.signature(value).parameters.items()
        if name != "self"
    ]
    return str(inspect.Signature(parameters))


def test_every_name_is_there_with_its_parameters(page):
    entries = documented(page)
    assert len(entries) > 30
    wrong = {
        f"{module}.{name}{parameters}": signature(value) if parameters else "no longer called without ()"
        for module, name, parameters in entries
        if (value := named(module, name)) is not None
        and (signature(value) != parameters if parameters else callable(value) and hasattr(value, "__code__"))
    }
    assert wrong == {}


def test_it_names_everything_that_is_exported(page):
    assert [name for name in crfnet.__all__ if not re.search(rf"`[^`]*\b{name}\b", page)] == []


def test_its_examples_run(page, plate, tmp_path, monkeypatch):
    shutil.copyfile(plate, tmp_path / "plate01.jpg")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path / "data"))
    snippets = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    assert len(snippets) == 4
    names: dict[str, object] = {}
    for snippet in snippets:
        exec(snippet, names)
    assert (names["from_array"].pixels == names["same"].pixels).all()
    assert abs(names["curve"].forward(names["linear"]) - names["photo"].pixels).max() < 1e-6
    assert (tmp_path / "plate01.spi1d").is_file()


BATCH = partial(LinearBatch, out="out", options=EstimateOptions(), plates=PlateOptions(), lut=None)


@pytest.mark.parametrize(
    ("name", "call", "values"),
    [
        ("analysis", EstimateOptions, ("fast", ["fast"], {"window": 1}, np.arange(3))),
        ("plates", BATCH, ("half", {"exposur": 1})),
        ("out", BATCH, ("a\0b",)),
        ("history", FileMetadata, ("Adobe", None, (1,))),
        ("width", FileMetadata, (True, -1)),
        ("iso", FileMetadata, ("100", 1.5)),
        ("overwrite", partial(write_lut, "a.cube", Lut1D([0, 1])), ("no", 1, np.ones(2))),
        ("names", photograph_sources, (5, {"plate.jpg": ""})),
        ("sources", partial(estimate_files, options=EstimateOptions()), (None, "plate.jpg", ["plate.jpg"])),
        ("options", partial(estimate_files, ()), (None, {})),
        ("batch", partial(run_batch, photographs={}), (None,)),
        ("photographs", partial(run_batch, BATCH()), ([], {None: ""}, {"a\0b": ""}, {"a": "\ud800"})),
        ("scheduler", partial(run_batch, BATCH(), {}), (5, ["tcp://a:1"])),
        ("progress", partial(run_batch, BATCH(), {}), (5,)),
    ],
)
def test_an_argument_of_another_kind_is_a_crfnet_error_that_names_it(name, call, values, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for value in values:
        with pytest.raises(crfnet.CRFNetError) as caught:
            call(**{name: value})
        assert caught.value.facts["name"] == name
    assert not list(tmp_path.iterdir())

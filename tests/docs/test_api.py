import dataclasses
import importlib
import inspect
import re
import shutil

import pytest

import crfnet

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

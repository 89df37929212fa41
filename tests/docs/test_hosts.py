"""The files for Nuke are well-formed Tcl of known nodes. Nuke itself is not run."""

import re

import pytest

tkinter = pytest.importorskip("tkinter", reason="needs Tcl, the language of Nuke's files")

#: The knobs that the files set, by the node's class, as Foundry's reference guide and its published sources name them.
KNOBS = {
    "Gizmo": {"help", "addUserKnob"},
    "Input": {"inputs", "name"},
    "Output": {"name"},
    "Read": {"inputs", "file", "raw", "name"},
    "Write": {"file", "file_type", "datatype", "raw", "name"},
    "Multiply": {"channels", "value", "name"},
    "OCIOFileTransform": {"file", "invert", "interpolation", "name"},
    "OCIOColorSpace": {"in_colorspace", "out_colorspace", "name"},
    "OCIODisplay": {"colorspace", "display", "view", "name"},
}


def nodes_of(path):
    """The nodes of a Nuke file, as Tcl itself reads it: class and knobs; in the order of the file."""
    tcl = tkinter.Tcl()
    nodes = []

    def node(name, body):
        words = [str(word) for word in tcl.splitlist(body)]
        assert len(words) % 2 == 0, f"{path.name}: {name} has a knob without a value"
        nodes.append((name, list(zip(words[::2], words[1::2], strict=True))))
        return ""

    for name in KNOBS:
        tcl.createcommand(name, lambda body, name=name: node(name, body))
    for name in ("version", "push", "end_group", "stack"):
        tcl.createcommand(name, lambda *words: "node")
    tcl.eval(path.read_text(encoding="utf-8"))
    return nodes


@pytest.mark.parametrize("name", ["CameraResponse.gizmo", "plate01.nk"])
def test_tcl_reads_the_files(root, name):
    nodes = nodes_of(root / "docs" / "nuke" / name)
    assert len(nodes) > 4
    for kind, knobs in nodes:
        assert {knob for knob, _ in knobs} <= KNOBS[kind]
    names = [value for _, knobs in nodes for knob, value in knobs if knob == "name"]
    assert len(names) == len(set(names))


def test_the_expressions_ask_for_knobs_that_the_gizmo_has(root):
    path = root / "docs" / "nuke" / "CameraResponse.gizmo"
    (_, gizmo), *inner = nodes_of(path)
    knobs = {value.split()[1] for knob, value in gizmo if knob == "addUserKnob"}
    asked = set(re.findall(r"parent\.(\w+)", str(inner)))
    assert asked == {"lut", "stops", "invert"} <= knobs


def test_the_names_are_those_that_crfnet_writes(root):
    from crfnet.configs.plate_views import view_names
    from crfnet.output_files import OutputFiles

    files = OutputFiles.named(root / "look", [root / "plate01.jpg"])
    text = (root / "docs" / "nuke" / "plate01.nk").read_text(encoding="utf-8")
    for name in (f"look/{files.lut.name}", files.color_space, view_names(files.color_space)[0], files.linear[0].name):
        assert name in text

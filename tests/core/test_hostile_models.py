"""A model folder is untrusted input: whatever it holds, the answer is one line, and nothing else is read or run."""

import json
import os
import warnings

import numpy as np
import pytest

from crfnet_core.errors import ModelError
from crfnet_core.network import ResponseNetwork
from crfnet_core.network.model import MAX_GRAPH_SIZE
from tests.helpers.hostile_models import (
    ENTRIES,
    INT64,
    evidence_graph,
    field,
    graph_attribute,
    integer_attribute,
    model,
    node,
    tensor,
    value,
    write_model,
)

WINDOWS = np.full((2, 227, 227, 3), 0.5, np.float32)
OTHER_FILE = field(13, field(1, "location") + field(2, "secret.bin"))


def refusal(folder):
    """Return the message with which a model folder is refused, when it is loaded or when it is run."""
    with pytest.raises(ModelError) as caught:
        ResponseNetwork.load(folder).predict(WINDOWS)
    message = str(caught.value)
    assert message.startswith(str(folder))
    assert message.isprintable()
    return message


def test_a_crafted_graph_runs_if_nothing_is_wrong_with_it(tmp_path):
    found = ResponseNetwork.load(write_model(tmp_path / "m", model(evidence_graph(level=0.25)))).predict(WINDOWS)
    assert [evidence.location.tolist() for evidence in found.windows] == [[0.25] * 5] * 2


@pytest.mark.parametrize("location", ["secret.bin", "/etc/passwd", "../secret.bin", "/dev/zero"])
@pytest.mark.parametrize("marked", [b"", field(14, 1)])
def test_weights_in_another_file_are_refused(tmp_path, monkeypatch, location, marked):
    """Also where onnxruntime itself would look for it: in the current folder."""
    (tmp_path / "secret.bin").write_bytes(bytes(4))
    monkeypatch.chdir(tmp_path)
    more = field(13, field(1, "location") + field(2, location)) + marked
    outside = tensor("outside", (), (1,), more=more)
    assert "holds weights in another file" in refusal(
        write_model(tmp_path / "m", model(evidence_graph(tensors=(outside,))))
    )


@pytest.mark.parametrize(
    "attribute",
    [
        field(5, field(1, "value") + field(5, tensor("t", (), (1,), more=OTHER_FILE))),
        field(5, field(1, "values") + field(10, tensor("t", (), (1,), more=OTHER_FILE))),
        field(5, field(1, "sparse_value") + field(22, field(1, tensor("t", (), (1,), more=OTHER_FILE)))),
    ],
)
def test_weights_in_another_file_are_found_wherever_they_are(tmp_path, attribute):
    constant = node("Constant", "", "c", attributes=attribute)
    assert "another file" in refusal(write_model(tmp_path / "m", model(evidence_graph(nodes=(constant,)))))


@pytest.mark.parametrize("kind", ["Loop", "Scan", "If"])
def test_graphs_within_the_graph_are_refused(tmp_path, kind):
    """So there is no endless Loop."""
    inner = node(kind, "", "out", attributes=graph_attribute("body", field(2, "inner")))
    assert "holds a graph within the graph" in refusal(
        write_model(tmp_path / "m", model(evidence_graph(nodes=(inner,))))
    )


def test_functions_and_training_steps_are_refused(tmp_path):
    for more, found in ((field(25, field(1, "f")), "functions of its own"), (field(20, b""), "training steps")):
        folder = write_model(tmp_path / "m", model(evidence_graph(), more=more))
        assert f"holds {found}" in refusal(folder)


def test_operators_of_other_domains_are_refused(tmp_path):
    foreign = node("BiasGelu", "level level", "out", domain="com.microsoft")
    folder = write_model(tmp_path / "m", model(evidence_graph(nodes=(foreign,))))
    assert "uses operators that are not ONNX's own" in refusal(folder)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"no graph",
        b"\x08\x08ORTM" + bytes(100),
        b"\xff" * 50,
        field(7, 1),
        field(7, b"\x0b"),
        field(7, field(1, field(7, 1))),
        model(evidence_graph())[:-3],
    ],
)
def test_what_is_no_graph_is_refused(tmp_path, content):
    assert "model.onnx" in refusal(write_model(tmp_path / "m", content))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"inputs": (value("other", ("n", 227, 227, 3)),)}, ""),
        ({"inputs": (value("windows", ("n", 227, 227, 3)), value("more", (1,)))}, "has 2 inputs"),
        ({"inputs": (value("windows", ("n", 100, 227, 3)),)}, "has windows of tensor(float) ['n', 100, 227, 3]"),
        ({"inputs": (value("windows", ("n", 9)),)}, "has windows of"),
        ({"inputs": (value("windows", ("n", 227, 227, 3), kind=INT64),)}, "has windows of tensor(int64)"),
        ({"shapes": {"factors": ("n", 5)}}, ""),
        ({"shapes": {"factors": ()}}, ""),
        ({"kind": INT64}, ""),
        ({"level": float("nan")}, "answers with locations that is not finite"),
        ({"level": float("inf")}, "answers with locations that is not finite"),
        ({"level": 3e38}, "or above 1e+09"),
        ({"nodes": (node("Nonsense", "level", "out"),)}, "onnxruntime cannot load"),
        ({"nodes": (node("Div", "first first", "out"),)}, "onnxruntime cannot load"),
    ],
)
def test_inputs_and_outputs_of_another_kind_are_refused(tmp_path, capfd, changes, said):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert said in refusal(write_model(tmp_path / "m", model(evidence_graph(**changes))))
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("operator", "inputs"),
    [
        ("Reshape", "windows huge_shape"),
        ("Expand", "level huge_shape"),
        ("ConstantOfShape", "huge_shape"),
        ("Gather", "windows huge_shape"),
    ],
)
def test_what_fails_while_it_runs_is_one_line(tmp_path, capfd, operator, inputs):
    """The shape depends on the number of windows, so that nothing is known of it before."""
    huge = tensor("huge", (10**4,) * 4, (4,), kind=INT64)
    nodes = (
        node("Shape", "windows", "windows_shape"),
        node("Mul", "windows_shape huge", "huge_shape"),
        node(operator, inputs, "outcome"),
        node("ReduceMax", "outcome", "largest", attributes=integer_attribute("keepdims", 0)),
    )
    graph = evidence_graph(nodes=nodes, tensors=(huge,), source="largest")
    assert "model.onnx fails (" in refusal(write_model(tmp_path / "m", model(graph)))
    assert capfd.readouterr().err == ""


def test_outputs_that_turn_out_to_have_other_shapes_are_refused(tmp_path):
    graph = evidence_graph(rows={"factors": (5, 4)}, shapes={"factors": ("n", "a", "b")})
    folder = write_model(tmp_path / "m", model(graph))
    assert "answers with factors of shape (1, 5, 4), needed is (1, 5, 5)" in refusal(folder)


@pytest.mark.parametrize(
    "entries",
    [
        {"output_names": 5},
        {"output_names": []},
        {"output_names": ["locations"] * 3},
        {"output_names": [["locations"], "factors", "log_odds"]},
        {"input_name": {}},
        {"input_name": "pixels"},
        {"accuracy": None},
        {"accuracy": {"P0": 1}},
        {"accuracy": {"P0": {"E_est": "\x1b[31m"}}},
        {"training": []},
        {"opset": "18"},
        {"components": True},
        {"sha256": 5},
        {"name": "a" * 200000},
        {"name": "\x1b[31mred"},
        {"name": "\ud800"},
        {"name": ""},
        {"normalization": "two\nlines"},
    ],
)
def test_entries_of_other_types_are_refused(tmp_path, entries):
    folder = write_model(tmp_path / "m", model(evidence_graph()))
    path = folder / "model.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | entries))
    assert "cannot be what a model has" in refusal(folder)


@pytest.mark.parametrize("text", ["[" * 200000, '{"name": NaN}', '{"name": 1e999}', '{"name": ' + "9" * 5000 + "}"])
def test_what_is_no_sound_json_is_refused(tmp_path, text):
    folder = write_model(tmp_path / "m", model(evidence_graph()))
    (folder / "model.json").write_text(text)
    assert "is not JSON" in refusal(folder)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
@pytest.mark.parametrize("name", ["model.onnx", "model.json"])
def test_pipes_devices_and_huge_files_are_not_read(tmp_path, name):
    path = write_model(tmp_path / "m", model(evidence_graph())) / name
    path.unlink()
    os.mkfifo(path)
    assert "it is not a regular file" in refusal(tmp_path / "m")
    path.unlink()
    path.symlink_to("/dev/zero")
    assert "it is not a regular file" in refusal(tmp_path / "m")
    path.unlink()
    path.touch()
    os.truncate(path, MAX_GRAPH_SIZE + 1)
    assert "it has more than" in refusal(tmp_path / "m")


def test_names_that_are_no_text_are_refused(tmp_path):
    graph = evidence_graph(inputs=(value("windows", ("n", 227, 227, 3)), value("other", (1,))))
    content = model(graph).replace(b"other", b"\xff\xfeher")
    assert "onnxruntime cannot load" in refusal(write_model(tmp_path / "m", content))


def test_a_number_of_outputs_that_is_no_evidence_is_refused(tmp_path):
    folder = write_model(tmp_path / "m", model(evidence_graph()), output_names=["locations", "factors"])
    assert "has 2 outputs, needed are 3" in refusal(folder)


def test_a_hostile_model_writes_nothing(crfnet, plate, tmp_path):
    folder = write_model(tmp_path / "m", model(evidence_graph(level=float("nan"))))
    done = crfnet("estimate", plate, "--out", tmp_path / "out", "--model", folder)
    assert done.code == 2
    assert done.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_entries_of_a_sound_model_are_taken(tmp_path):
    assert ResponseNetwork.load(write_model(tmp_path / "m", model(evidence_graph()))).config.name == ENTRIES["name"]

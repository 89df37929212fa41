"""Model folders by hand, whose graphs say what no exporter would: ONNX's messages as Protocol Buffers."""

from __future__ import annotations

import hashlib
import json
import struct
from pathlib import Path
from typing import Any

FLOAT, INT64 = 1, 7

#: model.json of a network that reads windows.
ENTRIES = {
    "name": "crafted",
    "basis": "emor",
    "components": 5,
    "window_size": 227,
    "input_name": "windows",
    "output_names": ["locations", "factors", "log_odds"],
    "normalization": "none",
    "opset": 17,
    "training_commit": "none",
    "training": {},
    "accuracy": {},
}

#: The outputs of such a network and the shapes of their rows.
OUTPUTS = {"locations": (5,), "factors": (5, 5), "log_odds": (3,)}


def field(number: int, value: int | bytes | str) -> bytes:
    """Return a field of a message: an integer, or bytes."""
    if isinstance(value, int):
        return _varint(number << 3) + _varint(value)
    content = value.encode() if isinstance(value, str) else value
    return _varint(number << 3 | 2) + _varint(len(content)) + content


def tensor(
    name: str, values: tuple[float, ...], shape: tuple[int, ...], *, kind: int = FLOAT, more: bytes = b""
) -> bytes:
    """Return a TensorProto."""
    packed = struct.pack(f"<{len(values)}{'f' if kind == FLOAT else 'q'}", *values)
    content = packed and field(9, packed)
    return b"".join(field(1, size) for size in shape) + field(2, kind) + field(8, name) + content + more


def node(kind: str, inputs: str, outputs: str, *, domain: str = "", attributes: bytes = b"") -> bytes:
    """Return a NodeProto; names are separated by blanks."""
    names = b"".join(field(1, name) for name in inputs.split()) + b"".join(field(2, name) for name in outputs.split())
    return names + field(4, kind) + attributes + (field(7, domain) if domain else b"")


def integer_attribute(name: str, number: int) -> bytes:
    """Return the attribute of a node that holds an integer."""
    return field(5, field(1, name) + field(3, number) + field(20, 2))


def graph_attribute(name: str, graph: bytes) -> bytes:
    """Return the attribute of a node that holds a graph."""
    return field(5, field(1, name) + field(6, graph) + field(20, 5))


def value(name: str, shape: tuple[int | str, ...], *, kind: int = FLOAT) -> bytes:
    """Return a ValueInfoProto."""
    sizes = b"".join(field(1, field(1, size) if isinstance(size, int) else field(2, size)) for size in shape)
    return field(1, name) + field(2, field(1, field(1, kind) + field(2, sizes)))


def evidence_graph(
    *,
    nodes: tuple[bytes, ...] = (),
    tensors: tuple[bytes, ...] = (),
    shapes: dict[str, tuple[int | str, ...]] | None = None,
    inputs: tuple[bytes, ...] = (),
    level: float = 0.0,
    source: str = "level",
    rows: dict[str, tuple[int, ...]] | None = None,
    kind: int = FLOAT,
) -> bytes:
    """Return a GraphProto that answers `level` for each window, whatever it holds, after further nodes.

    Parameters
    ----------
    nodes, tensors, inputs : tuple of bytes
        Further nodes and initial tensors, and the inputs; by default windows.
    shapes : dict, optional
        Output -> declared shape, instead of that of evidence.
    level : float
        The answer.
    source : str
        The value that is answered: `level`, or a scalar that further nodes make.
    rows : dict, optional
        Output -> shape of its rows, instead of that of evidence.
    kind : int
        The declared type of the outputs.
    """
    declared = {name: ("n", *row) for name, row in OUTPUTS.items()} | (shapes or {})
    constants = [tensor("level", (level,), ())]
    steps = [node("Shape", "windows", "shape"), node("Slice", "shape first second", "count")]
    constants += [tensor("first", (0,), (1,), kind=INT64), tensor("second", (1,), (1,), kind=INT64)]
    for name, row in (OUTPUTS | (rows or {})).items():
        constants.append(tensor(f"{name}_row", row, (len(row),), kind=INT64))
        steps.append(node("Concat", f"count {name}_row", f"{name}_shape", attributes=integer_attribute("axis", 0)))
        steps.append(node("Expand", f"{source} {name}_shape", name))
    parts = [field(1, step) for step in (*nodes, *steps)] + [field(2, "crafted")]
    windows = value("windows", ("n", 227, 227, 3))
    parts += [field(5, each) for each in (*constants, *tensors)] + [field(11, each) for each in inputs or (windows,)]
    parts += [field(12, value(name, shape, kind=kind)) for name, shape in declared.items()]
    return b"".join(parts)


def model(graph: bytes, *, more: bytes = b"") -> bytes:
    """Return a ModelProto."""
    return field(1, 8) + field(7, graph) + field(8, field(1, "") + field(2, 17)) + more


def write_model(folder: Path, content: bytes, **entries: Any) -> Path:
    """Write a model folder whose hash is right, and return it."""
    folder.mkdir(exist_ok=True)
    (folder / "model.onnx").write_bytes(content)
    described = {**ENTRIES, "sha256": hashlib.sha256(content).hexdigest(), **entries}
    (folder / "model.json").write_text(json.dumps(described), encoding="utf-8")
    return folder


def _varint(number: int) -> bytes:
    """Return an integer as seven bits a byte."""
    content = bytearray()
    while number > 0x7F:
        content.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes([*content, number])

"""What a model.onnx may hold. A model folder is untrusted input, so its graph is looked at before onnxruntime loads it.

Refused is what could read other files, run without an end, or run anything but ONNX's own operators: weights in another
file, graphs within the graph (Loop, Scan, If), functions, and operators of other domains.

Source: ONNX, `onnx/onnx.proto3`; Protocol Buffers, "Encoding".
"""

from __future__ import annotations

from collections.abc import Iterator

#: Message -> number of a field that holds messages -> their kind.
_CHILDREN = {
    "model": {7: "graph"},
    "graph": {1: "node", 5: "tensor", 15: "sparse tensor"},
    "node": {5: "attribute"},
    "attribute": {5: "tensor", 10: "tensor", 22: "sparse tensor", 23: "sparse tensor"},
    "sparse tensor": {1: "tensor", 2: "tensor"},
    "tensor": {},
}

#: Message and number of a field that must be absent, or 0 -> what it holds.
_REFUSED = {
    ("model", 20): "training steps",
    ("model", 25): "functions of its own",
    ("attribute", 6): "a graph within the graph, as Loop, Scan and If have",
    ("attribute", 11): "graphs within the graph",
    ("tensor", 13): "weights in another file",
    ("tensor", 14): "weights in another file",
}

#: Message and number of the field that names the domain of an operator, and the names of ONNX's own.
_DOMAIN = ("node", 7)
_STANDARD = (b"", b"ai.onnx")

#: Protocol Buffers' wire types, and the number above those of all fields.
_VARINT, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5
_MOST_FIELDS = 1 << 29


def check_graph(content: bytes) -> None:
    """Check that a serialised ONNX model holds nothing that is refused.

    Raises
    ------
    ValueError
        If it does, or is no ONNX model; the message completes "model.onnx ...".
    """
    _check(memoryview(content), "model")


def _check(content: memoryview, kind: str) -> None:
    """Check a message and those inside it; they are nested five deep at most."""
    for number, value in _fields(content):
        if (kind, number) in _REFUSED and value != 0:
            raise ValueError(f"holds {_REFUSED[kind, number]}, which no response network needs")
        child = _CHILDREN[kind].get(number)
        if not isinstance(value, memoryview):
            if child or (kind, number) == _DOMAIN:
                raise ValueError("is no ONNX model")
        elif child:
            _check(value, child)
        elif (kind, number) == _DOMAIN and value.tobytes() not in _STANDARD:
            raise ValueError("uses operators that are not ONNX's own")


def _fields(content: memoryview) -> Iterator[tuple[int, int | memoryview]]:
    """Yield the number and the value of each field of a message: an integer, or bytes."""
    at = 0
    while at < len(content):
        key, at = _varint(content, at)
        number, wire = key >> 3, key & 7
        if not 0 < number < _MOST_FIELDS:
            raise ValueError("is no ONNX model")
        if wire == _VARINT:
            value, at = _varint(content, at)
            yield number, value
            continue
        if wire == _BYTES:
            length, at = _varint(content, at)
        else:
            length = {_FIXED64: 8, _FIXED32: 4}.get(wire, len(content))  # groups, which ONNX has none of, are too long
        if at + length > len(content):
            raise ValueError("is no ONNX model")
        yield number, content[at : at + length]
        at += length


def _varint(content: memoryview, at: int) -> tuple[int, int]:
    """Return the integer at a position, seven bits a byte, and the position behind it."""
    if at < len(content) and content[at] < 0x80:  # as most are, and a graph has ten thousands
        return content[at], at + 1
    value = 0
    for shift, byte in enumerate(content[at : at + 10]):
        value |= (byte & 0x7F) << 7 * shift
        if byte < 0x80:
            return value, at + shift + 1
    raise ValueError("is no ONNX model")

"""Bounds of an ONNX graph, checked before onnxruntime reads it: it takes up to forty times the size of small parts.

The parts are found by Protocol Buffers' rules for messages, https://protobuf.dev/programming-guides/encoding, and the
numbers of `onnx.proto`.
"""

import re
from collections.abc import Iterator
from pathlib import Path

from crfnet_core.errors import ModelError

#: Most parts of a model or of its graph, such as nodes, and bytes of all but its weights. The packaged models have 4350
#: parts and 2.3 million bytes.
MOST_PARTS, MOST_STRUCTURE = 16384, 4 * 2**20

#: Of a model its graph; of the graph its weights, and those that are stored sparsely; of weights the numbers.
_GRAPH, _INITIALIZER, _SPARSE, _RAW_DATA = 7, 5, 15, 9

#: Bytes of a field's content, by the last three bits of its key: a number, 64 bits, a length and as many, 32 bits.
_NUMBER, _LENGTH, _SIZES = 0, 2, {0: 0, 1: 8, 5: 4}

#: Names for weights in another file, and for others stored sparsely; and the byte before such a name, which ends the
#: number of its letters.
_FORBIDDEN, _BEFORE = re.compile(rb"location|sparse_value"), (0, 8, 12)


def check_graph(folder: Path, content: bytes) -> None:
    """Raise ModelError unless a model.onnx is a message with all its weights, and within the bounds."""
    if any(content[match.start() - 1] in _BEFORE for match in _FORBIDDEN.finditer(content)):
        raise ModelError("external_weights", folder=folder)
    weights = 0
    try:
        for number, graph in _parts(memoryview(content)):
            for inner, part in _parts(graph) if number == _GRAPH else ():
                if inner == _SPARSE:
                    raise ModelError("external_weights", folder=folder)
                if inner == _INITIALIZER:
                    weights += sum(len(data) for field, data in _parts(part) if field == _RAW_DATA)
    except ValueError as problem:
        raise ModelError("unloadable_graph", folder=folder, reason=problem) from None
    if len(content) - weights > MOST_STRUCTURE:
        reason = f"it has more than {MOST_STRUCTURE // 2**20} MiB besides its weights"
        raise ModelError("unloadable_graph", folder=folder, reason=reason)


def _parts(message: memoryview) -> Iterator[tuple[int, memoryview]]:
    """Yield the number and the content of each part of a message; raise ValueError if it is none, or has too many."""
    place = count = 0
    while place < len(message):
        key, place = _number(message, place)
        if key & 7 == _NUMBER:
            _, place = _number(message, place)
        size, place = _number(message, place) if key & 7 == _LENGTH else (_SIZES.get(key & 7, -1), place)
        if size < 0 or place + size > len(message) or key >= 2**32:  # of which others see the low bits
            raise ValueError("it is cut short or is not ONNX")
        count += 1
        if count > MOST_PARTS:
            raise ValueError(f"it has more than {MOST_PARTS} parts")
        yield key >> 3, message[place : place + size]
        place += size


def _number(message: memoryview, place: int) -> tuple[int, int]:
    """Return a number of seven bits a byte, and the place behind it."""
    number = 0
    for shift, byte in enumerate(message[place : place + 10]):
        number |= (byte & 127) << 7 * shift
        if byte < 128:
            return number, place + shift + 1
    raise ValueError("it is cut short or is not ONNX")

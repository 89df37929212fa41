"""The items of a HEIF file (ISO/IEC 14496-12, 23008-12), and how often they are decoded: 80 KB can ask for 60 GP."""

from collections.abc import Iterator

from crfnet_core.photograph.image_io.iso_boxes import boxes

MOST_STEPS = 8  # most steps from an item to one that it is made of; phones need two


def has_named_items(meta: bytes) -> bool:
    """Return whether the types and names of all items are UTF-8; pi-heif 1.4 ends the process at others."""
    for kind, content in boxes(meta[4:]):
        if kind == b"iinf":
            for _, entry in boxes(content[6 if content[:1] == b"\0" else 8 :]):  # behind the number of entries
                try:
                    entry[10 if entry[:1] > b"\2" else 8 :].decode()  # behind the version, the flags and the numbers
                except UnicodeDecodeError:
                    return False
    return True


def decoded_pixels(meta: bytes) -> int:
    """Return the pixels of the items that the largest item is made of, each as often as it is decoded.

    Raise ValueError if items refer to each other too deeply or in a circle, IndexError if a box is cut short.
    """
    areas, parts = dict[int, int](), dict[int, list[int]]()
    for kind, content in boxes(meta[4:]):
        if kind == b"iprp":
            for item, owned in _properties(content).items():
                sizes = [box for name, box in owned if name == b"ispe"]
                areas[item] = max((_number(box, 4, 4) * _number(box, 8, 4) for box in sizes), default=0)
        elif kind == b"iref":
            for item, others in _references(content):
                parts.setdefault(item, []).extend(others)
    sums: dict[int, int] = {}

    def pixels(item: int, steps: int) -> int:
        if steps > MOST_STEPS:
            raise ValueError("its items refer to each other too deeply")
        if item not in sums:
            sums[item] = areas.get(item, 0) + sum(pixels(part, steps + 1) for part in parts.get(item, ()))
        return sums[item]

    return max((pixels(item, 0) for item in {*areas, *parts}), default=0)


def is_turned(meta: bytes) -> bool:
    """Return whether the main item is turned or mirrored, by its properties `irot` and `imir`."""
    owned, main = dict[int, list[tuple[bytes, bytes]]](), 0
    for kind, content in boxes(meta[4:]):
        if kind == b"iprp":
            owned |= _properties(content)
        elif kind == b"pitm":
            main = _number(content, 4, 4 if content[:1] > b"\0" else 2)
    return any(name == b"imir" or (name == b"irot" and _number(box, 0, 1) & 3) for name, box in owned.get(main, ()))


def _properties(properties: bytes) -> dict[int, list[tuple[bytes, bytes]]]:
    """Return the properties of each item, each with its name: the box `iprp` has these, and who has which."""
    stored, found = [(b"", b"")], dict[int, list[tuple[bytes, bytes]]]()
    for kind, content in boxes(properties):
        if kind == b"ipco":
            stored += boxes(content)
        elif kind == b"ipma":
            place, size, width = 8, 4 if content[0] else 2, 2 if content[3] & 1 else 1
            while place < len(content):
                item, count = _number(content, place, size), _number(content, place + size, 1)
                ends = range(place + size + 1, place + size + 1 + count * width, width)
                indices = [_number(content, end, width) & (1 << 8 * width - 1) - 1 for end in ends]
                found.setdefault(item, []).extend(stored[index] for index in indices if index < len(stored))
                place = ends.stop
    return found


def _references(content: bytes) -> Iterator[tuple[int, list[int]]]:
    """Yield each item that is derived from others, and these: the entries `dimg` of the box `iref`."""
    size = 4 if content[:1] > b"\0" else 2
    for kind, box in boxes(content[4:]):
        if kind == b"dimg":
            yield _number(box, 0, size), [_number(box, place, size) for place in range(size + 2, len(box), size)]


def _number(content: bytes, place: int, size: int) -> int:
    """Return a number; 0 behind the end."""
    return int.from_bytes(content[place : place + size])

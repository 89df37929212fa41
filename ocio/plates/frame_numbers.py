"""Frame numbers in words: ranges such as 1-9x2, read by Fileseq, which the Blender add-on does without."""

import re
from collections.abc import Collection, Iterable, Sequence
from operator import index
from typing import Any

from ..errors import PlateError

#: Frames that a specification, or a sequence including its gaps, may span; more is taken for a mistake.
MAX_FRAMES = 1_000_000


def parse_frames(frames: str | Iterable[int]) -> tuple[int, ...]:
    """Return the frame numbers of a specification, ascending, each once; raise a PlateError if Fileseq refuses it."""
    if not isinstance(frames, str):
        return tuple(sorted({index(number) for number in frames}))
    from fileseq.exceptions import MaxSizeException, ParseException  # only here: see the module
    from fileseq.frameset import FrameSet

    is_plain = frames.isascii() and all(frames.split(",")) and not re.search(r"\d\s+\d", frames)  # 1 2 would be 12
    try:
        numbers: Collection[Any] = FrameSet(frames) if is_plain else ()
    except MaxSizeException:
        numbers = range(MAX_FRAMES + 1)
    except ParseException:
        numbers = ()
    if len(numbers) > MAX_FRAMES:
        raise PlateError("too_many_frames", frames=frames, most=MAX_FRAMES)
    if not numbers or any(number != int(number) for number in numbers):
        raise PlateError("bad_frames", frames=frames)
    return tuple(sorted(map(int, numbers)))


def format_frames(numbers: Sequence[int], limit: int = 5) -> str:
    """Return ascending frame numbers as ranges, for example "1-3, 7, 9-12", with an ellipsis after `limit` ranges."""
    ranges: list[list[int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][1] + 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    texts = [str(first) if first == last else f"{first}-{last}" for first, last in ranges]
    return ", ".join(texts[:limit]) + (", …" if len(texts) > limit else "")

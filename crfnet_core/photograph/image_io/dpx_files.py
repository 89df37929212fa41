"""DPX: refuse files of which OpenImageIO returns other pixels (SMPTE ST 268-1:2014, the generic image header)."""

import os
from functools import partial
from pathlib import Path
from typing import Any

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io.header_checks import damaged

#: Descriptors of RGB, RGBA and ABGR; and all that are read: also of luma, and of one color, as oiiotool writes it.
_RGB = (50, 51, 52)
_READ = (1, 2, 3, 6, *_RGB)

#: Places of the pixels that stand for none; OpenImageIO's name of the bytes behind each line.
_NO_PLACES, _PADDING = (0, 2**32 - 1), "dpx:EndOfLinePadding"


def check_dpx(path: Path, header: Any) -> None:
    """Refuse DPX that is misread, such as sheared where lines end at whole words and nothing says so, or cut short."""
    with path.open("rb") as file:
        head = file.read(812)
        number = partial(int.from_bytes, byteorder="big" if head.startswith(b"SDPX") else "little")
        place = number(head[808:])
        stored = file.seek(0, os.SEEK_END) - place
    elements, descriptor, packing, encoding = number(head[770:772]), head[800], number(head[804:806]), head[806:808]
    bits, samples = header.get_int_attribute("oiio:BitsPerSample"), header.nchannels * header.width
    sizes = {8: samples, 10: -(-samples // 3) * 4}  # three samples of 10 bits fill a word of 32
    line = -(-samples * bits // 32) * 4 if bits in (10, 12) and packing == 0 else sizes.get(bits, 2 * samples)
    is_padded = line % 4 and stored == (line + -line % 4) * header.height
    has_read_element = descriptor in (_RGB if elements > 1 else _READ)  # the first one alone is read
    problems = {
        "turned by a quarter": header.get_int_attribute("Orientation", 1) > 4,  # taken for lines of another length
        f"{elements} elements, the first of descriptor {descriptor}": not has_read_element,
        "runs": any(encoding),
        "its header does not state where the pixels are": place in _NO_PLACES,
        "lines of 10 bits that end within a word": bits == 10 and packing and samples % 3,
        "unnamed padding of lines; 10 bits have none": is_padded and not header.get_int_attribute(_PADDING),
    }
    problem = next((words for words, is_so in problems.items() if is_so), "")
    if problem:
        raise PhotoError("coding_not_read", path=path, kind="DPX", problem=problem)
    if stored < line * header.height:  # which OpenImageIO before version 3.2 reads nevertheless
        raise damaged(path, "DPX", "its end is missing")

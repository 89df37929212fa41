"""Damage files by chance: bytes, lines, words and the values of JSON documents; a seed gives the same damage again."""

import re
import struct

#: Numbers at which readers go wrong, as words of a text and as integers of 8, 16 and 32 bits.
_NUMBERS = "0 1 -1 2 0.5 1e-3 1e-50 1e38 -3.4e38 1e39 1e999 nan inf -inf 0x10 1_0 0,5 + - . 1e 65536 4294967296"
WORDS = (*_NUMBERS.split(), "\u0661", "", "true", "a", "\x1b[31m")
INTEGERS = (0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)

#: Values that no reader of a JSON document expects.
VALUES: tuple = (
    *(None, True, -1, 0, 1, 1e308, 10**30, "", "a", "\ud800", "\x1b", "x" * 5000),
    *([], {}, [[]], {"a": 1}, [None] * 5),
)


def mutated(content, generator):
    """Return a file with one to four faults anywhere."""
    for _ in range(generator.integers(1, 5)):
        step = _STEPS[generator.integers(len(_STEPS))]
        content = step(content, generator) if content else b"\0"
    return content


def mutated_text(text, generator, words=()):
    """Return a text with one to three faults in its lines and words; `words` are put into it beside `WORDS`."""
    lines = text.split("\n")
    for _ in range(generator.integers(1, 4)):
        at, other = generator.integers(len(lines), size=2)
        match generator.integers(6):
            case 0:
                lines.insert(at, lines[other])
            case 1 if len(lines) > 1:
                del lines[at]
            case 2:
                lines[at], lines[other] = lines[other], lines[at]
            case _:
                lines[at] = _with_other_word(lines[at], generator, (*WORDS, *words))
    return ("\r\n", "\r", "\n", "\n", "\n", "\n")[generator.integers(6)].join(lines)


def mutated_value(value, generator):
    """Return a JSON document in which one value, somewhere, is another, or one entry is gone."""
    if not isinstance(value, dict | list) or not value or generator.random() < 0.05:
        return VALUES[generator.integers(len(VALUES))]
    keys = list(value) if isinstance(value, dict) else list(range(len(value)))
    key = keys[generator.integers(len(keys))]
    changed = value.copy()
    if generator.random() < 0.1:
        del changed[key]
    else:
        changed[key] = mutated_value(value[key], generator)
    return changed


def _with_other_word(line, generator, words):
    """Return a line in which one word is another, or has another beside it."""
    parts = line.split(" ")
    at, word = generator.integers(len(parts)), words[int(generator.integers(len(words)))]
    parts[at] = word if generator.random() < 0.6 else f"{parts[at]} {word}"
    return " ".join(parts)


def _span(content, generator):
    """Return the ends of a part, short more often than long."""
    start = int(generator.integers(len(content)))
    return start, min(len(content), start + 1 + int(2 ** generator.uniform(0, 10)))


def _bit_flipped(content, generator):
    at = generator.integers(len(content))
    return content[:at] + bytes([content[at] ^ 1 << generator.integers(8)]) + content[at + 1 :]


def _integer_placed(content, generator):
    at, value = generator.integers(len(content)), INTEGERS[generator.integers(len(INTEGERS))]
    form = ("B", "<H", ">H", "<I", ">I")[generator.integers(5)]
    packed = struct.pack(form, value & (1 << 8 * struct.calcsize(form)) - 1)
    return content[:at] + packed + content[at + len(packed) :]


def _part_lost(content, generator):
    start, end = _span(content, generator)
    return content[:start] + content[end:]


def _part_repeated(content, generator):
    start, end = _span(content, generator)
    return content[:end] + content[start:]


def _part_noisy(content, generator):
    start, end = _span(content, generator)
    return content[:start] + generator.bytes(end - start) + content[end:]


def _part_zero(content, generator):
    start, end = _span(content, generator)
    return content[:start] + bytes(end - start) + content[end:]


def _cut(content, generator):
    return content[: generator.integers(len(content))]


def _text_recoded(content, generator):
    """Put text that is not UTF-8 into a word, as programs of other decades and countries write it."""
    words = list(re.finditer(rb"[A-Za-z]{4,40}", content[: 2**20]))
    if not words:
        return content
    word = words[generator.integers(len(words))]
    foreign = (("Voigtl\u00e4nder", "latin-1"), ("\u30ab\u30e1\u30e9", "shift-jis"), ("\u76f8\u673a", "gbk"))
    name, encoding = foreign[generator.integers(len(foreign))]
    text = (name.encode(encoding) * 8)[: len(word[0])]
    return content[: word.start()] + text + content[word.end() :]


_STEPS = (
    *(_text_recoded, _bit_flipped, _bit_flipped, _integer_placed, _integer_placed),
    *(_part_lost, _part_repeated, _part_noisy, _part_zero, _cut),
)

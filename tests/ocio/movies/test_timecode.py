"""Timecode is counted as SMPTE ST 12-1 counts it."""

from fractions import Fraction
from itertools import islice

import OpenImageIO as oiio
import pytest

from crfnet.movies.timecode import Timecode

NTSC, NTSC60 = Fraction(30000, 1001), Fraction(60000, 1001)


def labels(rate, dropped):
    """All numbers from 00:00:00 on, by the rule: the first ones of each minute are left out, but not of each tenth."""
    for minute in range(24 * 60):
        for second in range(60):
            for frame in range(rate):
                if minute % 10 and second == 0 and frame < dropped:
                    continue
                yield minute // 60, minute % 60, second, frame


@pytest.mark.parametrize(
    ("text", "rate", "nominal", "dropped"),
    [("00:00:00:00", Fraction(24), 24, 0), ("00:00:00;00", NTSC, 30, 2), ("00:00:00;00", NTSC60, 60, 4)],
)
def test_every_number_of_21_minutes_is_counted(text, rate, nominal, dropped):
    first = Timecode.parse(text, rate)
    expected = list(islice(labels(nominal, dropped), 21 * 60 * nominal))
    assert [first.later(frame).parts for frame in range(len(expected))] == expected


@pytest.mark.parametrize(("rate", "separator"), [(Fraction(25), ":"), (NTSC, ";"), (NTSC, ":"), (NTSC60, ";")])
def test_text_is_read_back(rate, separator):
    for text in ("00:00:59{}23", "00:01:00{}04", "00:10:00{}00", "01:00:00{}00", "23:59:59{}22"):
        assert str(Timecode.parse(text.format(separator), rate)) == text.format(separator)


def test_a_day_ends_at_midnight():
    for rate, separator in ((NTSC, ";"), (Fraction(24), ":")):
        last = Timecode.parse(f"23:59:59{separator}{round(rate) - 1}", rate)
        assert str(last.later(1)) == f"00:00:00{separator}00"


def test_an_hour_of_drop_frame_is_107892_frames():
    assert str(Timecode.parse("00:00:00;00", NTSC).later(107892)) == "01:00:00;00"


@pytest.mark.parametrize("text", ["", "1:2:3:4", "01:00:00:24", "later"])
def test_other_texts_are_none(text):
    assert Timecode.parse(text, Fraction(24)) is None


def test_rates_that_timecode_cannot_count_have_none():
    assert Timecode.parse("01:00:00:00", Fraction(120)) is None
    assert Timecode.parse("01:00:00:00", Fraction(0)) is None


def test_openexr_reads_the_packed_words():
    header = oiio.ImageSpec(8, 8, 3, "half")
    header.attribute("smpte:TimeCode", oiio.TypeTimeCode, Timecode.parse("12:34:56;23", NTSC).packed)
    assert header.getattribute("smpte:TimeCode") == (0x12345623 | 1 << 6, 0)  # bit 6: drop frame
    assert header.get_string_attribute("smpte:TimeCode") == "12:34:56:23"
    header.attribute("smpte:TimeCode", oiio.TypeTimeCode, Timecode.parse("12:34:56:23", Fraction(24)).packed)
    assert header.get_string_attribute("smpte:TimeCode") == "12:34:56:23"


def test_above_30_frames_per_second_two_frames_share_a_number():
    first = Timecode.parse("01:00:00:58", Fraction(60))
    words = [first.later(frame).packed[0] for frame in range(3)]
    assert words == [0x01000029, 0x01008029, 0x01000100]

"""SMPTE timecode (ST 12-1): read as text, counted on from frame to frame, packed as OpenEXR keeps it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

#: Frames per second up to which the two digits of the frame, with the field bit, can count every frame.
MAX_RATE = 60

_TEXT = re.compile(r"(\d\d):(\d\d):(\d\d)([:;.])(\d\d)")


@dataclass(frozen=True)
class Timecode:
    """The timecode of a frame.

    Parameters
    ----------
    count : int
        Frames since 00:00:00:00, without those numbers that drop-frame counting leaves out.
    rate : int
        Frames per second as counted: 24 for 23.976, 30 for 29.97.
    is_drop_frame : bool
        Whether the first two numbers (four at 60) of each minute are left out, except every tenth minute.
    """

    count: int
    rate: int
    is_drop_frame: bool

    @classmethod
    def parse(cls, text: str, rate: Fraction) -> Timecode | None:
        """Return the timecode in a text such as "01:00:00:00", or "01:00:00;00" with drop-frame counting.

        Parameters
        ----------
        text : str
            The text.
        rate : Fraction
            Frames per second of the movie.

        Returns
        -------
        Timecode or None
            None if the text is none, or the rate is above `MAX_RATE`, which timecode cannot count.
        """
        match, nominal = _TEXT.fullmatch(text.strip()), round(rate)
        if match is None or not 1 <= nominal <= MAX_RATE or int(match[5]) >= nominal:
            return None
        hours, minutes, seconds, frames = (int(match[group]) for group in (1, 2, 3, 5))
        is_drop_frame = match[4] != ":" and nominal % 30 == 0
        count = (hours * 3600 + minutes * 60 + seconds) * nominal + frames
        if is_drop_frame:
            count -= _dropped(hours * 60 + minutes, nominal)
        return cls(count, nominal, is_drop_frame)

    def later(self, frames: int) -> Timecode:
        """Return the timecode so many frames later; after 24 hours it begins anew."""
        minutes = 24 * 60
        day = minutes * 60 * self.rate - (_dropped(minutes, self.rate) if self.is_drop_frame else 0)
        return Timecode((self.count + frames) % day, self.rate, self.is_drop_frame)

    @property
    def parts(self) -> tuple[int, int, int, int]:
        """Hours, minutes, seconds and frames."""
        number = self.count
        if self.is_drop_frame:
            dropped = self.rate // 15
            tens, rest = divmod(number, 600 * self.rate - 9 * dropped)
            number += 9 * dropped * tens + dropped * (max(0, rest - dropped) // (60 * self.rate - dropped))
        seconds, frames = divmod(number, self.rate)
        return seconds // 3600, seconds // 60 % 60, seconds % 60, frames

    def __str__(self) -> str:
        """Return the usual text, with a semicolon before the frame where numbers are dropped."""
        hours, minutes, seconds, frames = self.parts
        return f"{hours:02d}:{minutes:02d}:{seconds:02d}{';' if self.is_drop_frame else ':'}{frames:02d}"

    @property
    def packed(self) -> tuple[int, int]:
        """The two words of OpenEXR's timeCode: binary coded decimals, the drop-frame bit, and no user data.

        Above 30 frames per second two frames share a number, and the field bit marks the second (ST 12-1, 12.1).
        """
        hours, minutes, seconds, frames = self.parts
        field = 0
        if self.rate > 30:
            frames, field = divmod(frames, 2)
        parts = (frames, seconds, minutes, hours)
        digits = sum((part // 10 << 4 | part % 10) << 8 * index for index, part in enumerate(parts))
        return digits | self.is_drop_frame << 6 | field << 15, 0


def _dropped(minutes: int, rate: int) -> int:
    """Return how many numbers drop-frame counting leaves out in some minutes: 2 a minute at 30, but of each tenth."""
    return rate // 15 * (minutes - minutes // 10)

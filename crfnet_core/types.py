"""Names for the arrays that pass between modules, and for the callback that reports progress."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

#: Pixels, statistics, and what the network computes with.
Float32Array = NDArray[np.float32]

#: Responses, weights, and what is measured.
Float64Array = NDArray[np.float64]

#: Code values of 8 bits.
Uint8Array = NDArray[np.uint8]

#: Code values of 8 bits, where differences of them are taken.
Int16Array = NDArray[np.int16]

BoolArray = NDArray[np.bool_]

#: Positions in an array.
IndexArray = NDArray[np.intp]

#: Called with (done, total) after every step. If it raises, the work stops.
Progress = Callable[[int, int], None]

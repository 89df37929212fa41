"""onnxruntime, imported with its telemetry switched off: import it from here and from nowhere else.

From version 1.31 on it writes into the user's cache folder and looks up a host after ten seconds, unless this variable
is set before the import. `onnxruntime.disable_telemetry_events()` afterwards is too late.
"""

import os

os.environ["ORT_DISABLE_TELEMETRY"] = "1"

import onnxruntime

MOST_MEMORY = 2 * 2**30  # bytes of memory for the values of all networks that run in this process

_kind = onnxruntime.OrtAllocatorType.ORT_ARENA_ALLOCATOR
onnxruntime.create_and_register_allocator(
    onnxruntime.OrtMemoryInfo("Cpu", _kind, 0, onnxruntime.OrtMemType.DEFAULT),
    onnxruntime.OrtArenaCfg({"max_mem": MOST_MEMORY}),
)

__all__ = ["onnxruntime"]

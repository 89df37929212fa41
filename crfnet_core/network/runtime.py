"""onnxruntime, imported with its telemetry switched off: import it from here and from nowhere else.

From version 1.31 on it writes into the user's cache folder and looks up a host after ten seconds, unless this variable
is set before the import. `onnxruntime.disable_telemetry_events()` afterwards is too late.
"""

import os

os.environ["ORT_DISABLE_TELEMETRY"] = "1"

import onnxruntime

__all__ = ["onnxruntime"]

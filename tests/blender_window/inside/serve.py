"""Answer questions inside Blender, one at a time, in its own thread and between its events.

Blender runs this file as its startup script: ``blender --python serve.py -- SOCKET``. A question is one line of JSON:
a function of a module beside this one, such as ``editors.box``, with its arguments, or an expression. Nothing here
imports the project, because the add-on must find everything in its own package.
"""

from __future__ import annotations

import importlib
import json
import socket
import sys
import traceback
from pathlib import Path
from typing import Any

import bpy

#: Seconds between two looks for a question.
INTERVAL = 0.02

#: The modules beside this one.
MODULES = ("editors", "plates", "runs")


def serve(path: str) -> None:
    """Answer what is asked on a Unix socket, from now on."""
    server = socket.socket(socket.AF_UNIX)
    server.bind(path)
    server.listen()
    server.setblocking(False)
    modules = {name: importlib.import_module(name) for name in MODULES}

    def look() -> float:
        try:
            connection, _ = server.accept()
        except BlockingIOError:
            return INTERVAL
        with connection:
            connection.setblocking(True)
            with connection.makefile("rw", encoding="utf-8") as stream:
                found = answer(json.loads(stream.readline()), modules)
                stream.write(json.dumps(found, default=list) + "\n")
        return INTERVAL

    bpy.app.timers.register(look, first_interval=INTERVAL, persistent=True)


def answer(question: dict[str, Any], modules: dict[str, Any]) -> dict[str, Any]:
    """Return what a function returned or an expression is worth, or the traceback of what it raised."""
    try:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            if "expression" in question:
                return {"value": eval(question["expression"], {"bpy": bpy, **modules})}
            module, _, name = question["function"].partition(".")
            return {"value": getattr(modules[module], name)(*question["arguments"], **question["options"])}
    except BaseException:  # noqa: BLE001 - raised again where the question came from
        return {"error": traceback.format_exc()}


if __name__ == "__main__":
    sys.path.append(str(Path(__file__).parent))
    bpy.context.preferences.view.show_splash = False
    serve(sys.argv[-1])

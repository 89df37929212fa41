"""Let one call fail: a write, fsync, close or rename of Python below a folder, or the last page that an EXR flushes."""

import builtins
import io
import os
import signal
from pathlib import Path

import OpenImageIO as oiio

#: The calls of the module `os` that are counted, and whether their first argument is an open file.
CALLS = {"fsync": True, "close": True, "rename": False, "replace": False}


class Injector:
    """Counts the calls below a folder and lets the one of a number fail: with an errno, or with SIGKILL."""

    def __init__(self, folder: Path, *, number: int = -1, fault: int | None = None) -> None:
        self.folder, self.number, self.fault = str(folder), number, fault
        self.calls: list[str] = []
        self._real = {name: getattr(os, name) for name in CALLS}

    def count(self, name: str, path: object) -> None:
        """Count a call; fail if it is the chosen one."""
        if not str(path).startswith(self.folder):
            return
        self.calls.append(name)
        if len(self.calls) - 1 == self.number:
            if self.fault is None:
                os.kill(os.getpid(), signal.SIGKILL)
            raise OSError(self.fault, os.strerror(self.fault or 0), str(path))

    def install(self) -> None:
        """Replace the calls in this process, for good."""
        for name, takes_descriptor in CALLS.items():
            setattr(os, name, self._counted(name, takes_descriptor))
        opened = io.open
        injector = self

        def open_counted(file, mode="r", *arguments, **options):
            if not set(mode) & set("wax+") or isinstance(file, int):
                return opened(file, mode, *arguments, **options)
            raw = _Raw(os.fspath(file), mode.replace("b", "").replace("t", ""))
            raw.injector = injector
            buffered = io.BufferedRandom(raw) if "+" in mode else io.BufferedWriter(raw)
            text = {name: value for name, value in options.items() if name in ("encoding", "errors", "newline")}
            return buffered if "b" in mode else io.TextIOWrapper(buffered, **text)

        io.open = builtins.open = open_counted
        create = oiio.ImageOutput.create
        setattr(oiio.ImageOutput, "create", staticmethod(lambda path: _Output(create(path), path, injector)))  # noqa: B010

    def _counted(self, name, takes_descriptor):
        real, readlink = self._real[name], os.readlink

        def call(first, *arguments, **options):
            path = first
            if takes_descriptor:
                try:
                    path = readlink(f"/proc/self/fd/{first}")
                except OSError:
                    path = ""
            try:
                self.count(name, path)
            except OSError:
                if name == "close":  # as Linux does: the file is closed whatever it says
                    real(first)
                raise
            return real(first, *arguments, **options)

        return call


class _Raw(io.FileIO):
    """A file whose writes and close are counted."""

    def write(self, content):
        self.injector.count("write", self.name)
        return super().write(content)

    def close(self):
        is_open = not self.closed
        super().close()
        if is_open:
            self.injector.count("close", self.name)


class _Output:
    """OpenImageIO's output of a file: a failure cuts the last page off, of which OpenImageIO says nothing."""

    def __init__(self, output, path, injector):
        self._output, self._path, self._injector = output, path, injector

    def __getattr__(self, name):
        return getattr(self._output, name)

    def close(self):
        """Close the file."""
        is_closed = self._output.close()
        try:
            self._injector.count("flush", self._path)
        except OSError:
            os.truncate(self._path, max(Path(self._path).stat().st_size - 4096, 0))
        return is_closed

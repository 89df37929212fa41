"""Let one call of Python fail, such as write, fsync, rename or unlink below a folder, or the last page of an EXR."""

import builtins
import io
import os
import signal
from pathlib import Path

import OpenImageIO as oiio

#: The fault of a write that takes half of its bytes.
SHORT = "short"


class Injector:
    """Counts the calls below a folder and lets one, such as ("write", 3), fail: with an errno, `SHORT`, or SIGKILL."""

    def __init__(self, folder, *, call=None, fault=None):
        self.folder, self.call, self.fault, self.calls = str(folder), call, fault, []

    def count(self, name, path):
        """Count a call; fail if it is the chosen one. Return whether it has to be short."""
        if not str(path).startswith(self.folder):
            return False
        self.calls.append(name)
        if (name, self.calls.count(name)) == self.call:
            if self.fault is None:
                os.kill(os.getpid(), signal.SIGKILL)
            if self.fault == SHORT:
                return True
            raise OSError(self.fault, os.strerror(self.fault), str(path))
        return False

    def install(self):
        """Replace the calls in this process, for good."""
        for name in ("fsync", "close", "link", "rename", "replace", "mkdir", "unlink", "rmdir"):
            setattr(os, name, self._counted(name, getattr(os, name)))
        opened, create = io.open, oiio.ImageOutput.create

        def open_counted(file, mode="r", *arguments, **options):
            if not set(mode) & set("wax") or isinstance(file, int):
                return opened(file, mode, *arguments, **options)
            raw = _Raw(self, os.fspath(file), mode.replace("b", "").replace("t", ""))
            buffered = (io.BufferedRandom if "+" in mode else io.BufferedWriter)(raw)
            text = {name: value for name, value in options.items() if name in ("encoding", "errors", "newline")}
            return buffered if "b" in mode else io.TextIOWrapper(buffered, **text)

        io.open = builtins.open = open_counted
        setattr(oiio.ImageOutput, "create", staticmethod(lambda path: _Output(self, create(path), path)))  # noqa: B010

    def _counted(self, name, real):
        def call(first, *arguments, **options):
            descriptor = first if options.get("dir_fd") is None else options["dir_fd"]  # the folder's, in `rmtree`
            link = f"/proc/self/fd/{descriptor}"
            try:
                self.count(name, Path(link).readlink() if os.path.lexists(link) else first)
            except OSError:
                if name == "close":  # as Linux does: the file is closed whatever the error
                    real(first)
                raise
            return real(first, *arguments, **options)

        return call


class _Raw(io.FileIO):
    """A file whose writes and close are counted."""

    def __init__(self, injector, path, mode):
        self.injector = injector
        super().__init__(path, mode)

    def write(self, content):
        is_short = self.injector.count("write", self.name)
        return super().write(content[: max(1, len(content) // 2)] if is_short else content)

    def close(self):
        is_open = not self.closed
        super().close()
        if is_open:
            self.injector.count("close", self.name)


class _Output:
    """OpenImageIO's output of a file: a failure cuts the last page off, and OpenImageIO reports none."""

    def __init__(self, injector, output, path):
        self.injector, self.output, self.path = injector, output, Path(path)

    def __getattr__(self, name):
        return getattr(self.output, name)

    def close(self):
        is_closed = self.output.close()
        try:
            self.injector.count("flush", self.path)
        except OSError:
            os.truncate(self.path, max(self.path.stat().st_size - 4096, 0))
        return is_closed

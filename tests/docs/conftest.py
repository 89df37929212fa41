"""Run the commands that a page prints."""

import re
import shlex
from pathlib import Path

import pytest

#: What the tests cannot run: an installation, a cluster, and programs that need not be there.
NOT_RUN = ("pip ", "dask ", "ffmpeg ", "ociomergeconfigs ")


@pytest.fixture
def run_page(crfnet, oiiotool, tmp_path, monkeypatch):
    """Run every command of a page in the temporary folder, one after the other; return what each printed."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path / "data"))

    def run(page: Path) -> list[str]:
        blocks = re.findall(r"^```(\w*)\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
        commands = "".join(block for language, block in blocks if not language)
        lines = [line for line in commands.splitlines() if not line.startswith(NOT_RUN)]
        return [run_line(line) for line in lines if "--scheduler" not in line]

    def run_line(line: str) -> str:
        program, *words = shlex.split(line, comments=True)
        paths = [path for word in words for path in (sorted(tmp_path.glob(word)) if "*" in word else [word])]
        if program == "oiiotool":
            oiiotool(*paths)
            return ""
        assert program == "crfnet"
        done = crfnet(*paths)
        assert (done.code, done.err) == (0, ""), line
        return done.out

    return run

import io
import json
import sys

import pytest

from crfnet.cli.commands import printing
from crfnet.luts.files import WRITERS

COMMANDS = ("estimate", "linearize", "calibrate", "camera", "config", "info")


class TestHelp:
    @pytest.mark.parametrize("command", COMMANDS)
    def test_every_command_has_examples(self, crfnet, command):
        done = crfnet(command, "--help")
        assert done.code == 0
        assert f"examples:\n  crfnet {command} " in done.out

    def test_version(self, crfnet):
        assert crfnet("--version").out.startswith("crfnet 0.")


class TestInfo:
    @pytest.mark.parametrize("suffix", WRITERS)
    def test_of_a_lut(self, crfnet, look, suffix):
        out = crfnet("info", look / f"plate{suffix}").out
        assert f"plate{suffix}: 1D LUT of 4081 entries" in out
        assert "Photographs: plate.jpg" in out

    def test_of_a_lut_as_json(self, crfnet, look):
        document = json.loads(crfnet("info", look / "plate.spi1d", "--json").out)
        assert (document["kind"], document["length"], document["domain"]) == ("lut", 4081, [0, 1])
        *_, trust, primaries = document["provenance"]
        assert "Prior: camera; metadata: " in trust
        assert primaries.startswith("Primaries: Rec.709")


class TestProgressBar:
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    def test_moves_on_a_terminal(self, monkeypatch):
        monkeypatch.setattr(sys, "stderr", self.Terminal())
        monkeypatch.setenv("COLUMNS", "80")
        with printing.progress_bar("windows") as progress:
            progress(10, 10)
        assert "windows" in sys.stderr.getvalue()

    def test_is_a_line_a_minute_elsewhere(self, monkeypatch):
        seconds = iter([0, 59, 60, 61, 119, 130])
        monkeypatch.setattr(printing.time, "monotonic", lambda: next(seconds))
        monkeypatch.setattr(sys, "stderr", io.StringIO())
        with printing.progress_bar("frames") as progress:
            for done in range(1, 6):
                progress(done, 2997)
        lines = "crfnet: 2 of 2997 frames, 49:55:00 left\ncrfnet: 5 of 2997 frames, 27:00:40 left\n"
        assert sys.stderr.getvalue() == lines

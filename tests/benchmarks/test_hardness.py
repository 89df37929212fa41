"""The runs of benchmarks/hardness find what is wrong, and their table stands in docs/RELIABILITY.md."""

import json
import sys

import pytest

from benchmarks.hardness.disk_full import fill
from benchmarks.hardness.kills import kill
from benchmarks.hardness.pairs import pair
from benchmarks.hardness.soak import soak
from benchmarks.hardness.table import BEGIN, DOCUMENT, END, RESULTS, publish, results, table
from benchmarks.hardness.trial import Row, Trial

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="needs POSIX signals and limits")


class Written(Trial):
    """A trial of a small program instead of `crfnet`: it writes a.txt and b.txt, a moment apart."""

    program = (
        "import pathlib, sys, time\nout = pathlib.Path(sys.argv[1]); out.mkdir(exist_ok=True)\n"
        "(out / 'a.txt').write_text('a'); time.sleep(0.2); (out / 'b.txt').write_text('b' * 5000)\n"
    )

    def command(self, out):
        return [sys.executable, "-c", self.program, str(out)]


@pytest.fixture
def careless():
    """A program that writes one file after the other under its final name, without care."""
    return Written("careless", lambda out: [str(out)], {"a.txt": b"a", "b.txt": b"b" * 5000}, 0.3)


def test_a_careless_program_fails_where_there_is_no_room(careless, tmp_path):
    limited, full = fill([careless], 6, tmp_path)
    assert limited.failures
    assert full.cases in (0, 6)
    assert full.failures or "skipped" in full.note


def test_files_that_differ_are_found_in_pairs(tmp_path):
    other = Written("other", lambda out: [str(out)], {"a.txt": b"other", "b.txt": b"b" * 5000}, 0.3)
    (row,) = pair([other], 1, tmp_path)
    assert row.failures == ("a.txt has other bytes",)


def test_what_a_kill_leaves_is_looked_at(tmp_path):
    """The command itself, which writes something else than is expected here."""
    wrong = Trial("info", lambda out: ["info", "nonesuch"], {"a.txt": b""}, 0.1)
    rows = list(kill([wrong], 1, tmp_path))
    assert [row.cases for row in rows] == [1] * 4
    assert all("the second run ends with 2" in failure for row in rows[:1] for failure in row.failures)
    assert rows[0].failures


def test_one_estimate_is_soaked(tmp_path):
    row = soak(2, tmp_path)
    assert (row.cases, row.failures) == (2, ())
    assert " MB in the last; " in row.note


def test_the_results_are_published(tmp_path):
    document = tmp_path / "a.md"
    document.write_text(f"before\n{BEGIN}old\n{END}\nafter\n")
    rows = [Row("x", 3, ("bad | worse", "bad | worse")), Row("y", 2, (), "fine")]
    publish(results(rows, {"date": "2026-01-01", "commit": "abc"}), results_file=tmp_path / "a.json", document=document)
    text = document.read_text()
    assert text.startswith(f"before\n{BEGIN}2026-01-01, commit abc:\n")
    assert text.endswith(f"{END}\nafter\n")
    assert "| x | 3 | 2 | bad \\| worse |\n| y | 2 | 0 | fine |\n" in text
    assert json.loads((tmp_path / "a.json").read_text())["rows"][1]["cases"] == 2


def test_the_document_shows_the_results_that_are_kept():
    assert f"{BEGIN}{table(json.loads(RESULTS.read_text()))}{END}" in DOCUMENT.read_text(encoding="utf-8")

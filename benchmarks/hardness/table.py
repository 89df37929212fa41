"""The results as benchmarks/hardness.json and as the table of docs/RELIABILITY.md."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks.hardness.trial import ROOT, Row

RESULTS = ROOT / "benchmarks" / "hardness.json"
DOCUMENT = ROOT / "docs" / "RELIABILITY.md"

#: The lines between which the table stands.
BEGIN, END = "<!-- python -m benchmarks.hardness -->\n", "<!-- end -->"


def state() -> dict[str, str]:
    """Return today's date and the commit of the code; "-dirty" behind it says that files had been changed since."""
    commit = _git("rev-parse", "--short=12", "HEAD")
    changed = _git("status", "--porcelain", "--untracked-files=no")
    return {"date": datetime.now(UTC).date().isoformat(), "commit": f"{commit}-dirty" if changed else commit}


def results(rows: Sequence[Row], of: dict[str, str]) -> dict[str, Any]:
    """Return the results of a state of the code, ready for JSON."""
    return {**of, "rows": [asdict(row) for row in rows]}


def table(found: dict[str, Any]) -> str:
    """Return the results as a table of Markdown."""
    lines = [
        f"{found['date']}, commit {found['commit']}:",
        "",
        "| tried | cases | failures | |",
        "| --- | --: | --: | --- |",
    ]
    for row in found["rows"]:
        failures = len(row["failures"])
        note = "; ".join(filter(None, [row["note"], *sorted({*row["failures"]})[:1]])).replace("|", r"\|")
        lines.append(f"| {row['what']} | {row['cases']} | {failures} | {note} |")
    return "\n".join(lines) + "\n"


def publish(found: dict[str, Any], *, results_file: Path = RESULTS, document: Path = DOCUMENT) -> None:
    """Write the results as JSON, and as a table into the document."""
    results_file.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    before, _, rest = document.read_text(encoding="utf-8").partition(BEGIN)
    document.write_text(f"{before}{BEGIN}{table(found)}{END}{rest.partition(END)[2]}", encoding="utf-8")


def _git(*arguments: str) -> str:
    """Return what git says."""
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()

"""The report: a list of rows, each the figures of one estimator on one group of photographs, in report.json."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text

#: A row: "table", "group", "estimator", "photographs", and name of a figure -> value or [value, low, high].
ReportRow = dict[str, Any]


@dataclass(frozen=True)
class Report:
    """A whole evaluation; `models` are name -> SHA-256 of the graph, `notes` reasons not to compare the figures."""

    settings: dict[str, Any]
    models: dict[str, str]
    notes: list[str]
    rows: list[ReportRow]

    def table(self, *names: str) -> list[ReportRow]:
        """Return the rows of tables, one table after the other."""
        return [row for name in names for row in self.rows if row["table"] == name]

    def row(self, table: str, estimator: str, group: str = "") -> ReportRow:
        """Return the row of an estimator, empty where there is none."""
        rows = (row for row in self.table(table) if (row["estimator"], row["group"]) == (estimator, group))
        return next(rows, {})


def write_report(path: Path, report: Report) -> None:
    """Write report.json."""
    atomic_write_text(path, json.dumps(asdict(report), indent=1) + "\n", overwrite=True)


def read_report(path: Path) -> Report:
    """Return the report that `write_report` wrote; raise CRFNetError if the file is another one."""
    try:
        return Report(**json.loads(path.read_text()))
    except (ValueError, TypeError) as problem:
        raise CRFNetError(f"{path}: not a report of this version ({problem}); run training.evaluation again") from None


def value(figure: Any) -> Any:
    """Return a figure without its interval."""
    return figure[0] if isinstance(figure, list | tuple) else figure

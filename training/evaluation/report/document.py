"""report.json: a report written as JSON, and read back as the same dataclasses."""

from __future__ import annotations

import json
from dataclasses import asdict, fields, is_dataclass
from pathlib import Path
from types import UnionType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text
from training.evaluation.report.content import Report

#: Decimals of the figures in report.json.
DECIMALS = 4


def write_report(path: Path, report: Report) -> None:
    """Write report.json, every figure to `DECIMALS` decimals."""
    document = _rounded(asdict(report))
    atomic_write_text(path, json.dumps(document, indent=1) + "\n", overwrite=True)


def read_report(path: Path) -> Report:
    """Return the report that `write_report` wrote.

    Raises
    ------
    CRFNetError
        If the file holds no report of this version of the code.
    """
    try:
        report: Report = _from_document(Report, json.loads(path.read_text()))
    except (ValueError, KeyError, TypeError, AttributeError) as problem:
        raise CRFNetError(f"{path}: is no report of this version ({problem}); run training.evaluation again") from None
    return report


def _rounded(document: Any) -> Any:
    """Return a JSON document with all its floats rounded."""
    if isinstance(document, float):
        return round(document, DECIMALS)
    if isinstance(document, dict):
        return {key: _rounded(value) for key, value in document.items()}
    if isinstance(document, list | tuple):
        return [_rounded(value) for value in document]
    return document


def _from_document(kind: Any, document: Any) -> Any:
    """Return a JSON document as a value of the annotated type `kind`: a dataclass, tuple, dict, optional or plain."""
    origin, arguments = get_origin(kind) or kind, get_args(kind)
    if origin is UnionType:
        return None if document is None else _from_document(arguments[0], document)
    if isinstance(origin, type) and is_dataclass(origin):
        hints = get_type_hints(origin)
        kinds = {key: arguments[0] if isinstance(hint, TypeVar) else hint for key, hint in hints.items()}
        return origin(
            **{field.name: _from_document(kinds[field.name], document[field.name]) for field in fields(origin)}
        )
    if origin is tuple:
        return tuple(_from_document(arguments[0], value) for value in document)
    if origin is dict:
        return {key: _from_document(arguments[1], value) for key, value in document.items()}
    return document

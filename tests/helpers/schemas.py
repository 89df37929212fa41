"""The JSON schemas in docs/."""

import json
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"


def read_schema(name):
    """Return the schema docs/NAME.schema.json."""
    return dict(json.loads((DOCS / f"{name}.schema.json").read_text(encoding="utf-8")))


def problems_by(schema):
    """Return a function: the entries of a document that the schema forbids, or does not describe."""
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.Draft202012Validator.check_schema(schema)
    strict = jsonschema.Draft202012Validator(_closed(schema))
    return lambda document: [error.json_path for error in strict.iter_errors(document)]


def _closed(schema):
    """Return the schema with each object closed: for our own documents, every entry must be described."""
    if isinstance(schema, list):
        return list(map(_closed, schema))
    if not isinstance(schema, dict):
        return schema
    more = {"additionalProperties": False} if "properties" in schema and schema.get("type") == "object" else {}
    return more | {name: _closed(part) for name, part in schema.items()}

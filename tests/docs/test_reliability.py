"""docs/RELIABILITY.md names tests that are there."""

import re


def test_every_test_that_it_names_is_there(root):
    text = (root / "docs" / "RELIABILITY.md").read_text(encoding="utf-8")
    named = set(re.findall(r"\btest_\w+(?:\.py)?", text))
    assert len(named) > 25
    files = list((root / "tests").rglob("test_*.py"))
    known = {path.name for path in files}
    for path in files:
        known |= set(re.findall(r"def (test_\w+)\(", path.read_text(encoding="utf-8")))
    assert named <= known, sorted(named - known)

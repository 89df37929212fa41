"""The project's own documents and metadata hold together."""

import re
import tomllib
from importlib.metadata import version

import pytest


@pytest.fixture(scope="module")
def project(root):
    return tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]


DOCUMENTS = ("*.md", "docs/**/*.md", "blender_addon/*.md", "training/*.md", "tests/data/**/*.md")


def test_links_lead_somewhere(root):
    documents = [path for pattern in DOCUMENTS for path in root.glob(pattern)]
    assert len(documents) > 10
    assert not [f"{path.relative_to(root)}: {link}" for path in documents for link in broken_links(path)]


def broken_links(path):
    """The links of a document to files that are not there, and to headings that its target has not."""
    for target in re.findall(r"\]\(([^)]+)\)", path.read_text(encoding="utf-8")):
        file, _, heading = target.partition("#")
        linked = path.parent / file if file else path
        if "://" not in target and not (linked.exists() and (not heading or heading in anchors(linked))):
            yield target


def anchors(path):
    """The anchors that GitHub gives the headings of a document."""
    headings = re.findall(r"^#+ (.*)", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings}


def test_the_readme_names_every_target_that_it_uses(root):
    makefile = (root / "Makefile").read_text(encoding="utf-8")
    used = re.findall(r"^make ([a-z-]+)", (root / "README.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert used
    assert not [target for target in used if f"\n{target}:" not in makefile]


def test_the_installed_version_is_this_one(project):
    assert version("crfnet") == project["version"]


def test_licenses(root, project):
    assert project["license"] == "BSD-3-Clause"
    assert (root / "LICENSE").read_text().startswith("BSD 3-Clause License")
    assert "GNU GENERAL PUBLIC LICENSE" in (root / "blender_addon" / "LICENSE").read_text()[:200]

"""The project's own documents and metadata hold together."""

import re
import tomllib
from importlib.metadata import version

import pytest


@pytest.fixture(scope="module")
def project(root):
    return tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "tests/data/README.md"])
def test_links_lead_somewhere(root, name):
    text = (root / name).read_text(encoding="utf-8")
    targets = [target for target in re.findall(r"\]\(([^)#]+)\)", text) if "://" not in target]
    assert not [target for target in targets if not (root / name).parent.joinpath(target).exists()]


def test_the_readme_names_every_target_that_it_uses(root):
    makefile = (root / "Makefile").read_text(encoding="utf-8")
    used = re.findall(r"^make ([a-z-]+)", (root / "README.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert used
    assert not [target for target in used if f"\n{target}:" not in makefile]


def test_the_installed_version_is_this_one(project):
    assert version("crfnet") == project["version"]


def test_licences(root, project):
    assert project["license"] == "BSD-3-Clause"
    assert (root / "LICENSE").read_text().startswith("BSD 3-Clause License")
    assert "GNU GENERAL PUBLIC LICENSE" in (root / "blender_addon" / "LICENSE").read_text()[:200]

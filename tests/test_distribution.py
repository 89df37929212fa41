"""What others receive: the source distribution holds everything, and CITATION.cff says what pyproject.toml says."""

import shutil
import subprocess
import sys
import tomllib

import pytest
import yaml

#: Lists the files of a source distribution without making one: in a new folder, since setuptools believes an old list.
LIST_FILES = "import sys, setuptools; setuptools.setup(script_args=['-q', 'egg_info', '--egg-base', sys.argv[1]])"


@pytest.fixture(scope="module")
def project(root):
    return tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]


@pytest.fixture(scope="module")
def citation(root):
    return yaml.safe_load((root / "CITATION.cff").read_text(encoding="utf-8"))


def test_the_source_distribution_holds_the_whole_repository(root, tmp_path):
    """So that its tests run: `make test` in the unpacked distribution."""
    if shutil.which("git") is None or not (root / ".git").exists():
        pytest.skip("compares with what git keeps; this is not a git checkout")
    subprocess.run([sys.executable, "-c", LIST_FILES, tmp_path], cwd=root, check=True, capture_output=True)
    listed = (tmp_path / "crfnet.egg-info" / "SOURCES.txt").read_text(encoding="utf-8").splitlines()
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    kept = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout.split("\0")
    files = {name for name in kept if (root / name).is_file()}
    assert {name for name in listed if not name.startswith(str(tmp_path))} == files


def test_the_citation_has_what_its_format_asks_for(citation):
    assert citation["cff-version"] == "1.2.0"
    assert {"authors", "message", "title"} <= set(citation)
    for reference in citation["references"]:
        assert {"authors", "title", "type"} <= set(reference)


def test_the_citation_is_of_this_version(citation, project):
    assert (citation["version"], citation["license"]) == (project["version"], project["license"])
    assert citation["authors"] == project["authors"]

"""The source distribution holds everything, and the documents and metadata of the project hold together."""

import re
import shutil
import subprocess
import sys
import tomllib

import pytest
import yaml

#: Lists the files of a source distribution without making one: in a new folder, since setuptools believes an old list.
LIST_FILES = "import sys, setuptools; setuptools.setup(script_args=['-q', 'egg_info', '--egg-base', sys.argv[1]])"


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


def test_the_citation_has_what_its_format_asks_for_and_is_of_this_version(root):
    citation = yaml.safe_load((root / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0"
    assert {"message", "title"} <= set(citation)
    assert all({"authors", "title", "type"} <= set(reference) for reference in citation["references"])
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert [citation[name] for name in ("version", "license", "authors")] == [
        project[name] for name in ("version", "license", "authors")
    ]


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

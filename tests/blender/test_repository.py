"""All zips and their index, as Blender's own tool for extensions sees them."""

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import pytest

from blender_addon import build

pytestmark = pytest.mark.skipif(importlib.util.find_spec("bpy") is None, reason="needs Blender's bpy module")


@pytest.fixture
def extension_tool():
    """Blender's own tool for extensions: extension_tool("validate", ...) is a completed process."""
    (scripts,) = Path(importlib.util.find_spec("bpy").origin).parent.glob("*/scripts")
    tags = scripts / "modules" / "_bpy_internal" / "extensions" / "tags.py"

    def run(command, *arguments):
        options = [f"--valid-tags={tags}"] if command == "validate" else []
        tool = [sys.executable, str(scripts / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"), command]
        return subprocess.run([*tool, *map(str, arguments), *options], capture_output=True, text=True, check=False)

    return run


@pytest.fixture
def zips(tmp_path, monkeypatch):
    """All zips and their index; the wheels in them are empty, which only an installer would notice."""

    def empty(name):
        (tmp_path / name).touch()
        return tmp_path / name

    monkeypatch.setattr(build, "fetch_wheel", lambda name, cache: empty(name))
    monkeypatch.setattr(build, "build_own_wheel", lambda version, cache: empty(f"crfnet-{version}+h1-py3-none-any.whl"))
    return build.build_addon(list(build.ZIPS), out=tmp_path / "dist", cache=tmp_path)


def test_blender_finds_nothing_wrong_with_them(zips, extension_tool):
    for path in zips.values():
        done = extension_tool("validate", path)
        assert done.returncode == 0, done.stdout + done.stderr


def test_the_index_is_that_of_blenders_own_tool(zips, extension_tool):
    """But where two zips would fit, it offers one only; Blender's tool warns of them."""
    path = zips["linux-x64"].with_name("index.json")
    ours = json.loads(path.read_text())
    assert extension_tool("server-generate", f"--repo-dir={path.parent}").returncode == 0
    theirs = json.loads(path.read_text())
    for index in (ours, theirs):
        index["data"] = {entry["archive_url"]: entry for entry in index["data"]}
    any_python = f"./{zips['linux-x64-any-python'].name}"
    assert ours["data"][any_python].pop("python_versions") == ["3.12", "3.14"]
    assert theirs["data"][any_python].pop("python_versions") == ["3.11", "3.12", "3.13", "3.14"]
    assert ours == theirs

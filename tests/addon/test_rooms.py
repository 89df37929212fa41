"""The rooms of the add-on: `work` needs no Blender, and registering needs no estimator."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

IMPORT_WORK = """
import importlib, pkgutil, sys
sys.modules["bpy"] = None
import blender_addon.work
for module in pkgutil.iter_modules(blender_addon.work.__path__, "blender_addon.work."):
    importlib.import_module(module.name)
print(*sys.modules)
"""

#: What only the command needs, or only some photographs: the zips of the add-on may lack it.
OPTIONAL = ("av", "distributed", "fileseq", "matplotlib", "pi_heif", "tqdm")

BLOCKED = f"""
import sys
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {OPTIONAL}:
            raise ModuleNotFoundError(name + " is blocked", name=name)
sys.meta_path.insert(0, Absent())
"""


@pytest.fixture
def addon_folder(root) -> Path:
    return root / "blender_addon"


def loaded_by(code, root):
    """Modules that a fresh interpreter holds after running code that prints sys.modules."""
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.split())


def test_work_imports_neither_blender_nor_another_room(root):
    loaded = loaded_by(IMPORT_WORK, root)
    assert not [name for name in loaded if name.startswith(("blender_addon.ui", "blender_addon.scene"))]
    assert "blender_addon.lazy_import" not in loaded


def test_work_does_without_what_only_the_command_needs(root):
    loaded = loaded_by(BLOCKED + IMPORT_WORK, root)
    assert "blender_addon.work.run" in loaded
    assert not {name.partition(".")[0] for name in loaded} & set(OPTIONAL)


def test_no_import_of_blender_hides_in_a_function_of_work(addon_folder):
    for path in (addon_folder / "work").glob("*.py"):
        nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
        names = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
        names += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
        assert "bpy" not in {name.partition(".")[0] for name in names}, path


@pytest.mark.parametrize("room", ["ui", "ui/image_editor", "ui/more", "scene", "scene/nodes", "work"])
def test_the_map_of_a_room_names_its_modules(addon_folder, room):
    modules = {path.stem for path in (addon_folder / room).glob("*.py")} - {"__init__"}
    modules |= {path.parent.name for path in (addon_folder / room).glob("*/__init__.py")}
    text = ast.get_docstring(ast.parse((addon_folder / room / "__init__.py").read_text(encoding="utf-8")))
    assert {line.split()[0] for line in text.split("\n\n")[1].splitlines()} == modules


def test_the_suffixes_of_heic_that_are_there_before_the_estimator_are_its_own(addon_folder):
    from crfnet_core.photograph.image_io.file_kinds import HEIF_SUFFIXES

    tree = ast.parse((addon_folder / "scene" / "plates.py").read_text(encoding="utf-8"))
    assert f"HEIF_SUFFIXES = {HEIF_SUFFIXES}" in map(ast.unparse, tree.body)

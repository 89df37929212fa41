"""Who may import whom: `ocio -> crfnet_core <- training`, and no heavy guest in the core; and how large each may be."""

import subprocess
import sys

import pytest

import crfnet_core

PACKAGES = ("blender_addon", "crfnet_core", "ocio", "training")

#: The most lines of a module, and the most modules of a package beside its `__init__.py`: more want another room.
MOST_LINES, MOST_MODULES = 300, 12

IMPORT_ALL = """import importlib, pkgutil, sys, crfnet_core
for module in pkgutil.walk_packages(crfnet_core.__path__, "crfnet_core."):
    if ".raw_pairs" not in module.name:  # which nothing else imports until raw files are measured
        importlib.import_module(module.name)
"""

HEAVY = {"numpy", "onnxruntime", "OpenImageIO", "PyOpenColorIO", "matplotlib"}


@pytest.mark.parametrize(
    ("code", "guests"),
    [
        (IMPORT_ALL, {"bpy", "torch", "onnx", "PyOpenColorIO", "matplotlib", "tqdm", "scipy"}),
        # a name of the core is imported at its first use, and `crfnet --help` does not wait
        ("import crfnet_core", HEAVY),
        ("import crfnet.cli.main; crfnet.cli.main.build_parser()", HEAVY),
        # Blender's package holds neither the command's libraries nor matplotlib
        ("import crfnet.pipeline, crfnet.configs.derived", {"bpy", "torch", "matplotlib", "tqdm", "fileseq"}),
    ],
    ids=["core", "start of the core", "start of the command", "pipeline"],
)
def test_no_guest_is_loaded(root, code, guests):
    """By a fresh interpreter."""
    command = [sys.executable, "-c", f"{code}\nimport sys; print(*sys.modules)"]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert not {name.partition(".")[0] for name in done.stdout.split()} & guests


def test_every_public_name_and_module_of_the_core_is_there_and_no_other():
    for name in crfnet_core.__all__:
        assert getattr(crfnet_core, name).__module__.startswith("crfnet_core.")
    assert crfnet_core.posterior.Prior.__module__ == "crfnet_core.posterior.prior"
    with pytest.raises(AttributeError, match="nonesuch"):
        _ = crfnet_core.nonesuch


def test_only_image_io_reads_images(root):
    modules = (root / "crfnet_core").rglob("*.py")
    readers = {path.parent.name for path in modules if "OpenImageIO as" in path.read_text(encoding="utf-8")}
    assert readers == {"image_io"}


def test_the_import_contracts_are_kept(root, monkeypatch, capsys):
    cli = pytest.importorskip("importlinter.cli", reason="import-linter comes with the dev extra")
    monkeypatch.chdir(root)
    assert cli.lint_imports(cache_dir=None, no_cache=True) == 0, capsys.readouterr().out


def test_no_module_is_long(root):
    lines = {
        str(path.relative_to(root)): len(path.read_text(encoding="utf-8").splitlines())
        for folder in (*PACKAGES, "tests")
        for path in (root / folder).rglob("*.py")
    }
    assert {name: count for name, count in lines.items() if count > MOST_LINES} == {}


def test_no_package_has_many_modules(root):
    packages = [path.parent for folder in PACKAGES for path in (root / folder).rglob("__init__.py")]
    modules = {str(path.relative_to(root)): len(list(path.glob("*.py"))) - 1 for path in packages}
    assert {name: count for name, count in modules.items() if count > MOST_MODULES} == {}

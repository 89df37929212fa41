"""The zips of `make addon`: reproducible, complete in a Blender that has nothing else, and replaced by others."""

import importlib.metadata
import importlib.util
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest

from blender_addon import build
from crfnet.luts.files import read_lut
from crfnet_core import ResponseNetwork, estimate_response, read_photo
from tests.helpers.colored_ramp import colored_ramp

pytestmark = pytest.mark.skipif(importlib.util.find_spec("bpy") is None, reason="needs Blender's bpy module")

#: The add-on from a zip, and from a repository.
MODULE, SERVED = "bl_ext.user_default.crf_response", "bl_ext.studio.crf_response"

#: Blender's name of this machine.
PLATFORM = "-".join(
    {"darwin": "macos", "x86_64": "x64", "amd64": "x64"}.get(part, part)
    for part in (platform.system().lower(), platform.machine().lower())
)

# One process installs, as `blender -c extension ...`. As a module, Blender reads no preferences by itself.
INSTALL = """
import json, sys
import bpy
from bl_pkg.bl_extension_cli import cli_extension_handler
bpy.ops.wm.read_userpref()
bpy.context.preferences.system.use_online_access = True
for command in json.loads(sys.argv[-1]):
    assert cli_extension_handler(command) == 0, command
print("FOUND " + json.dumps([addon.module for addon in bpy.context.preferences.addons]))
"""

# The next process asks for the estimator.
STATE = """
import importlib, importlib.metadata, json, sys
import bpy
bpy.ops.wm.read_userpref()
import crfnet_core
missing = importlib.import_module(sys.argv[-1] + ".lazy_import").missing()
print("FOUND " + json.dumps([importlib.metadata.version("crfnet"), hasattr(crfnet_core.errors, "OLDER"), missing]))
"""

# Or it estimates.
ESTIMATE = """
import json, sys
import bpy
plate, folder, heic = sys.argv[-3:]
bpy.ops.wm.read_userpref()
image = bpy.data.images.load(plate)
print(bpy.ops.crf.estimate_response(image=image.name, apply="EXPORT", folder=folder))
import crfnet_core, crfnet, onnxruntime, OpenImageIO, PyOpenColorIO
packages = (crfnet_core, crfnet, onnxruntime, OpenImageIO, PyOpenColorIO)
stray = sorted({"tqdm", "matplotlib", "google", "flatbuffers", "pi_heif"} & set(sys.modules))
codes = crfnet_core.photograph.image_io.read_codes(heic).codes
import pi_heif, PIL
packages += (pi_heif, PIL)
found = {
    "files": {package.__name__: package.__file__ for package in packages},
    "onnxruntime": onnxruntime.__version__,
    "operator": [list(image["camera_response"]["weights"]), image["camera_response"]["model"]],
    "stray": stray,
    "heic": codes.tolist(),
}
print("FOUND " + json.dumps(found))
"""


def build_zip(sources, out, umask, root):
    """The zip of this machine's platform, built from sources by the command that make runs."""
    if PLATFORM not in build.ZIPS:
        pytest.skip(f"no zip is made for {platform.system()} on {platform.machine()}")
    command = [sys.executable, str(sources / "blender_addon" / "build.py"), "--platform", PLATFORM, "--out", str(out)]
    command += ["--cache", str(root / "build" / "wheels")]
    done = subprocess.run(command, capture_output=True, text=True, umask=umask, check=False)
    if "cannot be downloaded" in done.stderr:
        pytest.skip(done.stderr.strip())
    assert done.returncode == 0, done.stderr
    (path,) = out.glob("*.zip")
    return path


@pytest.fixture(scope="module")
def package(root, tmp_path_factory):
    return build_zip(root, tmp_path_factory.mktemp("dist"), 0o022, root)


@pytest.fixture(scope="module")
def older_package(root, tmp_path_factory):
    """A zip of the same version from other sources, as a user has it who built it a week before."""
    sources = tmp_path_factory.mktemp("older")
    for name in build.SOURCES:
        build._copy(root / name, sources / name)
    with (sources / "crfnet_core" / "errors.py").open("a", encoding="utf-8") as file:
        file.write("OLDER = True\n")
    return build_zip(sources, tmp_path_factory.mktemp("dist"), 0o022, root)


def build_of(package):
    """The version of the wheel of `crfnet` in a zip."""
    (wheel,) = (name for name in zipfile.ZipFile(package).namelist() if "/crfnet-" in name)
    return wheel.split("-")[1]


def bpy_requirements(name="bpy"):
    """Names of the installed distributions that `name` needs, itself included."""
    try:
        needed = importlib.metadata.requires(name) or []
    except importlib.metadata.PackageNotFoundError:
        return set()
    return {name}.union(*(bpy_requirements(re.match(r"[\w.-]+", line)[0]) for line in needed if "extra ==" not in line))


@pytest.fixture(scope="module")
def bare_python(tmp_path_factory):
    """Python of an environment that holds bpy and what it requires: links to this one's packages, nothing else."""
    folder = tmp_path_factory.mktemp("bare")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    (packages,) = folder.glob("lib/python*/site-packages")
    for name in bpy_requirements():
        distribution = importlib.metadata.distribution(name)
        for top in {file.parts[0] for file in distribution.files} - {"..", "__pycache__"}:
            (packages / top).symlink_to(distribution.locate_file(top))
    assert not any((packages / name).exists() for name in ("onnxruntime", "OpenImageIO", "PyOpenColorIO"))
    return folder / "bin" / "python"


def run_blender(python, user, script, *arguments):
    """What a script found out in a Blender whose user folder is `user`."""
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(user)}
    for name in ("OCIO", "BLENDER_OCIO"):
        environment.pop(name, None)
    command = [str(python), "-I", "-c", script, *map(str, arguments)]
    done = subprocess.run(command, env=environment, cwd=user, capture_output=True, text=True, timeout=80, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Policy violation" not in done.stdout + done.stderr
    return json.loads(next(line for line in done.stdout.splitlines() if line.startswith("FOUND "))[6:])


@pytest.fixture(scope="module")
def user(tmp_path_factory):
    """An empty folder for everything that Blender keeps of a user."""
    return tmp_path_factory.mktemp("user")


@pytest.fixture(scope="module")
def served(package, older_package, bare_python, user, tmp_path_factory):
    """The folder from which one session installs, and another one updates when it has a newer zip."""
    folder = tmp_path_factory.mktemp("served")
    shutil.copytree(older_package.parent, folder, dirs_exist_ok=True)
    add = ["repo-add", "--name", "Studio", "--url", (folder / "index.json").as_uri(), "studio"]
    install = ["install", "--sync", "--enable", "studio.crf_response"]
    assert SERVED in run_blender(bare_python, user, INSTALL, json.dumps([["repo-remove", "blender_org"], add, install]))
    shutil.copytree(package.parent, folder, dirs_exist_ok=True)
    run_blender(bare_python, user, INSTALL, json.dumps([["update", "--sync"]]))
    return folder


@pytest.fixture(scope="module")
def found(served, bare_python, user, plate, root):
    """The findings of the next session."""
    return run_blender(
        bare_python, user, ESTIMATE, plate, user / "look", root / "tests" / "data" / "heif" / "rgb8.heic"
    )


def test_the_same_sources_give_the_same_bytes(root, package, tmp_path):
    again = build_zip(root, tmp_path / "again", 0o077, root)
    assert again.name == package.name
    assert again.read_bytes() == package.read_bytes()


def test_the_zip_holds_the_add_on_and_its_wheels(root, package):
    modules = {path.relative_to(root / "blender_addon").as_posix() for path in build.shipped_files()}
    with zipfile.ZipFile(package) as archive:
        inside = tomllib.loads(archive.read("blender_manifest.toml").decode())
        wheels = {wheel.removeprefix("./") for wheel in inside["wheels"]}
        assert set(archive.namelist()) == modules | wheels | {"blender_manifest.toml"}
    assert (inside["platforms"], inside["version"]) == ([PLATFORM], build_of(package))
    assert {"__init__.py", "LICENSE", "scene/packed_images.py"} <= modules
    assert "build.py" not in modules


def test_our_wheel_holds_core_ocio_and_the_model(package, tmp_path):
    version = build_of(package)
    with zipfile.ZipFile(package) as archive:
        wheel = archive.extract(f"wheels/crfnet-{version}-py3-none-any.whl", tmp_path)
    with zipfile.ZipFile(wheel) as archive:
        inside = archive.namelist()
    tops = {name.partition("/")[0] for name in inside}
    assert tops == {"crfnet_core", "crfnet", f"crfnet-{version}.dist-info"}
    assert {"crfnet_core/data/emor.npz", "crfnet_core/data/priors/camera.json"} <= set(inside)
    assert [name for name in inside if re.fullmatch("crfnet_core/models/[^/]+/model.(onnx|json)", name)]


def test_everything_comes_from_its_wheels_or_from_blender(found, package, user):
    site_packages = user / "extensions" / ".local" / "lib"
    for name in ("crfnet_core", "crfnet", "onnxruntime", "pi_heif", "PIL"):
        assert site_packages in Path(found["files"][name]).parents, found["files"][name]
    for name in ("OpenImageIO", "PyOpenColorIO"):
        assert "bpy" in Path(found["files"][name]).parts, found["files"][name]
    assert any(f"/onnxruntime-{found['onnxruntime']}-cp" in name for name in zipfile.ZipFile(package).namelist())
    assert found["stray"] == []


def test_a_folder_with_a_newer_zip_updates_the_estimator(served, bare_python, user, package, older_package):
    assert build_of(older_package) != build_of(package)
    assert run_blender(bare_python, user, STATE, SERVED) == [build_of(package), False, ""]


def test_another_zip_replaces_the_estimator_in_either_direction(bare_python, package, older_package, tmp_path):
    for zip_file in (older_package, package, package, older_package):
        install = [["install-file", "--repo", "user_default", "--enable", str(zip_file)]]
        run_blender(bare_python, tmp_path, INSTALL, json.dumps(install))
        state = run_blender(bare_python, tmp_path, STATE, MODULE)
        assert state == [build_of(zip_file), zip_file == older_package, ""]


def test_its_wheels_read_heic(found):
    np.testing.assert_array_equal(found["heic"], colored_ramp(8))


def test_its_estimate_is_that_of_the_onnxruntime_here(found, plate, tolerance):
    here, (weights, model) = estimate_response(read_photo(plate), network=ResponseNetwork.load()), found["operator"]
    assert model == here.model
    np.testing.assert_allclose(weights, here.weights, atol=tolerance.parity)


def test_the_exported_lut_is_the_inverse_response(found, user, plate, tolerance):
    exported = list((user / "look").glob("*.spi1d"))  # and the one of the config
    here = estimate_response(read_photo(plate), network=ResponseNetwork.load())
    brightness = np.linspace(0, 1, 256)
    assert len(exported) == 2
    for path in exported:
        light = read_lut(path).apply(brightness)
        np.testing.assert_allclose(light, here.curve.inverse(brightness), atol=tolerance.parity)


def test_two_enabled_copies_of_the_addon_are_named(addon):
    import bpy

    from blender_addon import lazy_import

    second = bpy.context.preferences.addons.new()
    second.module = "bl_ext.user_default.blender_addon"
    line = lazy_import.missing()
    bpy.context.preferences.addons.remove(second)
    assert line.endswith("uninstall the copy of blender_addon or User Default")
    assert not lazy_import.missing()


@pytest.mark.parametrize("is_imported", [False, True])
def test_an_estimator_of_another_build_asks_for_a_restart(monkeypatch, tmp_path, is_imported):
    """Between the update of the add-on and the next start of Blender, which may have replaced the files already."""
    from blender_addon import lazy_import

    if is_imported:
        lazy_import.load("crfnet")
        monkeypatch.setattr(importlib.metadata, "version", lambda _: "0.1.0+00000000")
    (tmp_path / "blender_manifest.toml").write_text('wheels = ["./wheels/crfnet-0.1.0+00000000-py3-none-any.whl"]\n')
    monkeypatch.setattr(lazy_import, "__file__", str(tmp_path / "lazy_import.py"))
    lazy_import._missing_library.cache_clear()
    line = lazy_import.missing()
    lazy_import._missing_library.cache_clear()
    assert "0.1.0+00000000" in line
    assert line.endswith("restart Blender")

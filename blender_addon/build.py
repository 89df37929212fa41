# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the Blender extension, one zip per platform and one for the Blenders of Linux distributions: `make addon`.

Needs only the standard library and pip. The wheels that wheels.sha256 lists are downloaded and kept in build/wheels, so
the next build needs no network. The same sources give the same bytes: the members of a zip are sorted by name,
uncompressed, and all of one date; the wheel of `crfnet_core` and `crfnet` is built by the setuptools of wheels.sha256,
from a folder that holds nothing else.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from urllib.parse import quote

#: The exit code after a failure.
FAILED = 2

ADDON = Path(__file__).resolve().parent
ROOT = ADDON.parent
MANIFEST = "blender_manifest.toml"

#: Blender's name of each platform, and how the platform tags of its wheels begin and end.
WHEEL_PLATFORMS = {
    "linux-x64": ("manylinux", "x86_64"),
    "macos-arm64": ("macosx", "arm64"),
    "macos-x64": ("macosx", "x86_64"),
    "windows-x64": ("win", "amd64"),
}

#: The versions of Python in Blender as blender.org builds it, whose wheels are in the zip of each platform.
OFFICIAL_PYTHONS = ("cp311", "cp313")

#: The zips that are built, with their platform and their versions of Python; None for every one of the manifest.
ZIPS: dict[str, tuple[str, tuple[str, ...] | None]] = {
    **{platform: (platform, OFFICIAL_PYTHONS) for platform in WHEEL_PLATFORMS},
    "linux-x64-any-python": ("linux-x64", None),
}

#: Files of this folder that go into the zip, and exceptions from them.
SHIPPED = ("LICENSE", "**/*.py")
NOT_SHIPPED = ("build.py",)

#: Files and folders of the project from which our own wheel is built.
WHEEL_SOURCES = ("pyproject.toml", "README.md", "LICENSE", "crfnet_core", "ocio")

#: The earliest date that a zip can hold.
DATE = (1980, 1, 1, 0, 0, 0)


class BuildError(Exception):
    """A reason why the extension cannot be built, in one line."""


def main(argv: Sequence[str] | None = None) -> int:
    """Build the zips that the command line asks for, and return the exit code, 0 or `FAILED`."""
    options = _parser().parse_args(argv)
    try:
        for path in build_addon(options.platform or list(ZIPS), out=options.out, cache=options.cache):
            sys.stdout.write(f"{path}  {path.stat().st_size / 1e6:.1f} MB\n")
    except (BuildError, OSError) as problem:
        sys.stderr.write(f"{problem}\n")
        return FAILED
    return 0


def build_addon(names: Sequence[str], *, out: Path, cache: Path) -> list[Path]:
    """Write zips and our own wheel, each with its list of components; return the paths of the zips.

    `names` are keys of `ZIPS`, `out` is the folder for the zips, and `cache` keeps the downloads.

    Raise BuildError if a wheel cannot be downloaded or has another SHA-256, or the version numbers disagree.
    """
    text = (ADDON / MANIFEST).read_text(encoding="utf-8")
    own_wheel = build_own_wheel(tomllib.loads(text)["version"], cache)
    text = re.sub(r"crfnet-[^-\n]+-py3-none-any\.whl", own_wheel.name, text)
    manifest = tomllib.loads(text)
    out.mkdir(parents=True, exist_ok=True)
    zips = []
    for zip_name in names:
        platform, pythons = ZIPS[zip_name]
        members = {path.relative_to(ADDON).as_posix(): path for path in shipped_files()}
        wheels = platform_wheels(manifest["wheels"], platform, pythons)
        for wheel in wheels:
            name = Path(wheel).name
            members[wheel.removeprefix("./")] = own_wheel if name == own_wheel.name else fetch_wheel(name, cache)
        contents = {name: path.read_bytes() for name, path in members.items()}
        contents[MANIFEST] = platform_manifest(text, platform, wheels).encode()
        zips.append(out / f"{manifest['id']}-{manifest['version']}-{zip_name.replace('-', '_')}.zip")
        write_zip(zips[-1], contents)
        write_sbom(zips[-1], [members[wheel.removeprefix("./")] for wheel in wheels])
    shutil.copyfile(own_wheel, out / own_wheel.name)
    write_sbom(out / own_wheel.name, [])
    return zips


def shipped_files() -> list[Path]:
    """Return the files of this folder that go into every zip; the manifest, which differs, is not among them."""
    paths = {path for pattern in SHIPPED for path in ADDON.glob(pattern)}
    return sorted(path for path in paths if path.relative_to(ADDON).as_posix() not in NOT_SHIPPED)


def platform_wheels(wheels: Sequence[str], platform: str, pythons: Sequence[str] | None = None) -> list[str]:
    """Return the wheels of the manifest that run on a platform, for some versions of Python or for every one."""
    system, machine = WHEEL_PLATFORMS[platform]
    chosen = []
    for wheel in wheels:
        python, _, tag = Path(wheel).stem.split("-")[-3:]
        is_for_platform = tag.startswith(system) and tag.endswith(machine)
        if tag == "any" or (is_for_platform and (pythons is None or python in pythons)):
            chosen.append(wheel)
    return chosen


def platform_manifest(text: str, platform: str, wheels: Sequence[str]) -> str:
    """Return the text of the manifest with only one platform and its wheels.

    Blender's own `--split-platforms` adds a table [build.generated] instead, which nothing but its installer reads.
    """
    for key, values in (("platforms", [platform]), ("wheels", wheels)):
        lines = "".join(f"    {json.dumps(value)},\n" for value in values)
        text, count = re.subn(rf"^{key} = \[\n.*?^\]$", f"{key} = [\n{lines}]", text, flags=re.MULTILINE | re.DOTALL)
        if count != 1:
            raise BuildError(f"{MANIFEST}: needs one list `{key}` with one line per entry, found {count}")
    return text


def build_own_wheel(version: str, cache: Path) -> Path:
    """Build the wheel that holds `crfnet_core` and `crfnet` in the folder of the downloads, and return its path.

    Its version ends in a hash of its sources, such as 0.1.0+h1f3a5b7c: Blender keeps an installed wheel if another of
    the same name and version comes with a newer zip.

    The wheel declares the dependencies of the `crfnet` command. Blender ignores them: it comes with numpy, OpenImageIO
    and OpenColorIO, and the add-on does not import what only the command needs (tqdm, matplotlib).
    """
    fetch_wheel(_setuptools(), cache)
    with tempfile.TemporaryDirectory() as folder:
        source, out = Path(folder, "source"), Path(folder, "out")
        for name in WHEEL_SOURCES:
            _copy(ROOT / name, source / name)
        build = f"{version}+{_digest(source)}"
        project = (source / "pyproject.toml").read_text(encoding="utf-8")
        project = re.sub(rf'^version = "{re.escape(version)}"$', f'version = "{build}"', project, flags=re.MULTILINE)
        (source / "pyproject.toml").write_text(project, encoding="utf-8")
        arguments = ["wheel", "--no-deps", "--no-index", f"--find-links={cache.resolve()}", f"--wheel-dir={out}"]
        _pip([*arguments, str(source)], "our own wheel cannot be built", options={"PIP_CONFIG_FILE": os.devnull})
        (wheel,) = out.glob("*.whl")
        if wheel.name.split("-")[1] != build:
            raise BuildError(f"{MANIFEST} has version {version}, pyproject.toml makes {wheel.name}: make them equal")
        with zipfile.ZipFile(wheel) as archive:
            contents = {name: archive.read(name) for name in archive.namelist()}
    for older in cache.glob("crfnet-*.whl"):
        older.unlink(missing_ok=True)
    write_zip(cache / wheel.name, contents)
    return cache / wheel.name


def fetch_wheel(name: str, cache: Path) -> Path:
    """Return the path of a wheel of wheels.sha256 in the cache; download it if it is absent or damaged."""
    expected = _expected_hashes().get(name)
    if expected is None:
        raise BuildError(f"{name}: has no line in wheels.sha256; download it and add its SHA-256")
    path = cache / name
    if path.is_file() and _sha256(path) == expected:
        return path
    cache.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=cache) as folder:
        _download(name, Path(folder))
        digest = _sha256(Path(folder, name))
        if digest != expected:
            raise BuildError(f"{name}: the download has SHA-256 {digest}, wheels.sha256 has {expected}")
        Path(folder, name).replace(path)
    return path


def write_zip(path: Path, contents: Mapping[str, bytes]) -> None:
    """Write a zip whose bytes depend on its members alone: stored, since deflate differs between versions of zlib."""
    temporary = path.with_name(f".{path.name}")
    with zipfile.ZipFile(temporary, "w") as archive:
        for name in sorted(contents):
            info = zipfile.ZipInfo(name, DATE)
            info.create_system = 3  # Unix, on every system
            info.external_attr = 0o100644 << 16
            archive.writestr(info, contents[name])
    temporary.replace(path)


def write_sbom(path: Path, wheels: Sequence[Path]) -> None:
    """Write the CycloneDX list of a zip and the wheels in it, or of a wheel, next to it: `NAME.cdx.json`."""
    main = {"type": "application", "name": path.name, "hashes": _hashes(path)}
    document = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": main if wheels else _component(path)},
        "components": [_component(wheel) for wheel in sorted(wheels)],
    }
    text = json.dumps(document, indent=1) + "\n"
    path.with_name(f"{path.name}.cdx.json").write_text(text, encoding="utf-8", newline="\n")


def _component(wheel: Path) -> dict[str, object]:
    """Return the component of a wheel: its name, version, package URL and SHA-256."""
    name, version = wheel.name.split("-")[:2]
    project = name.replace("_", "-").lower()
    purl = f"pkg:pypi/{project}@{quote(version)}?file_name={quote(wheel.name)}"
    parts = {"type": "library", "name": project, "version": version, "purl": purl, "bom-ref": purl}
    return parts | {"hashes": _hashes(wheel)}


def _hashes(path: Path) -> list[dict[str, str]]:
    """Return the SHA-256 of a file as CycloneDX has it."""
    return [{"alg": "SHA-256", "content": _sha256(path)}]


def _parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(prog="build.py", description="Build the Blender extension, one zip per platform.")
    parser.add_argument("--platform", action="append", choices=ZIPS, help="again for more (default: all)")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="where the zips go (default: dist)")
    parser.add_argument("--cache", type=Path, default=ROOT / "build" / "wheels", help="keeps downloads (build/wheels)")
    return parser


def _expected_hashes() -> dict[str, str]:
    """Return the SHA-256 of every wheel that may be downloaded, by the name of the wheel."""
    lines = (ADDON / "wheels.sha256").read_text(encoding="utf-8").splitlines()
    return {name: digest for digest, name in map(str.split, lines)}


def _setuptools() -> str:
    """Return the name of the setuptools wheel that builds our own."""
    (name,) = (name for name in _expected_hashes() if name.startswith("setuptools-"))
    return name


def _digest(folder: Path) -> str:
    """Return a letter, since versions drop leading zeros of numbers, and a hash of a folder's files by eight digits."""
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    lines = "".join(f"{_sha256(folder / name)}  {name}\n" for name in names)
    return f"h{hashlib.sha256(lines.encode()).hexdigest()[:8]}"


def _sha256(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _download(name: str, folder: Path) -> None:
    """Download the wheel of this name with pip, for any platform and version of Python."""
    project, version, python, _, tags = Path(name).stem.split("-")
    arguments = ["download", "--no-deps", "--only-binary=:all:", f"--dest={folder}", f"{project}=={version}"]
    if python.startswith("cp"):
        arguments += ["--implementation=cp", f"--python-version={python[2:]}"]
        arguments += [f"--platform={tag}" for tag in tags.split(".")]
    _pip(arguments, f"{name}: cannot be downloaded; check the network")
    if not (folder / name).is_file():
        raise BuildError(f"{name}: cannot be downloaded (pip found {next(folder.iterdir()).name} instead)")


def _pip(arguments: Sequence[str], failure: str, *, options: Mapping[str, str] | None = None) -> None:
    """Run pip; raise a BuildError with its last error if it fails. `options` replace the environment's."""
    users = {name: value for name, value in os.environ.items() if options is None or not name.startswith("PIP_")}
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", *arguments]
    done = subprocess.run(command, env=users | dict(options or {}), capture_output=True, text=True, check=False)
    if done.returncode:
        lines = done.stderr.splitlines() or ["pip gives no reason"]
        errors = [line for line in lines if line.startswith("ERROR")] or lines
        raise BuildError(f"{failure} (pip: {errors[-1].removeprefix('ERROR: ').strip()})")


def _copy(source: Path, target: Path) -> None:
    """Copy a file, or a folder without the bytecode that Python leaves in it."""
    if source.is_dir():
        shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
    else:
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)


if __name__ == "__main__":
    sys.exit(main())

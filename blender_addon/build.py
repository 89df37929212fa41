# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the Blender extension, one zip per platform and one for the Blenders of Linux distributions: `make addon`.

The folder of the zips is a repository of extensions, from which Blender installs and updates: it has an `index.json`.
Needs only the standard library and pip. The wheels that wheels.sha256 lists are downloaded once and kept. The same
sources give the same bytes: the members of a zip are sorted by name, uncompressed, and all of one date; the wheel of
`crfnet_core` and `crfnet` is built by the setuptools of wheels.sha256, from a folder that holds nothing else.
"""

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
from typing import Any, NamedTuple
from urllib.parse import quote

ADDON = Path(__file__).resolve().parent
ROOT = ADDON.parent
MANIFEST, INDEX = "blender_manifest.toml", "index.json"

#: The versions of Python in Blender as blender.org builds it, and in all Blenders, such as a distribution's.
OFFICIAL, ALL = ("cp311", "cp313"), ("cp311", "cp312", "cp313", "cp314")


class Zip(NamedTuple):
    """One of the zips: Blender's name of its platform, which wheels are for it, and who needs it."""

    platform: str
    tag: str  # a pattern of the platform tags of its wheels
    pythons: tuple[str, ...]
    audience: str


ZIPS = {
    "linux-x64": Zip("linux-x64", "manylinux.*x86_64", OFFICIAL, "Linux: Blender 4.5 to 5.2 from blender.org"),
    "macos-arm64": Zip(
        "macos-arm64", "macosx.*arm64", OFFICIAL, "Apple silicon, macOS 13 or newer: Blender 4.5 to 5.2"
    ),
    "macos-x64": Zip("macos-x64", "macosx.*x86_64", ("cp311",), "Intel Macs, macOS 13 or newer: Blender 4.5"),
    "windows-x64": Zip("windows-x64", "win_amd64", OFFICIAL, "Windows: Blender 4.5 to 5.2"),
    "linux-x64-any-python": Zip(
        "linux-x64", "manylinux.*x86_64", ALL, "Linux: other Blenders with Python 3.11 to 3.14"
    ),
}

#: Files of this folder that go into the zip, all but this one.
SHIPPED = ("LICENSE", "README.md", "pictures/*.png", "**/*.py")

#: Files and folders of the project whose contents are in the version of a build.
SOURCES = ("pyproject.toml", "README.md", "LICENSE", "crfnet_core", "ocio", "blender_addon")


class BuildError(Exception):
    """A reason why the extension cannot be built, in one line."""


def main(argv: Sequence[str] | None = None) -> int:
    """Build the zips that the command line asks for, and return the exit code: 0, or 2 after a failure."""
    parser = argparse.ArgumentParser(prog="build.py", description="Build the Blender extension, one zip per platform.")
    parser.add_argument("--platform", action="append", choices=ZIPS, help="again for more (default: all)")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="where the zips go (default: dist)")
    parser.add_argument("--cache", type=Path, default=ROOT / "build" / "wheels", help="keeps downloads (build/wheels)")
    options = parser.parse_args(argv)
    try:
        zips = build_addon(options.platform or list(ZIPS), out=options.out, cache=options.cache)
    except (BuildError, OSError) as problem:
        sys.stderr.write(f"{problem}\n")
        return 2
    for name, path in zips.items():
        sys.stdout.write(f"{path}  {path.stat().st_size / 1e6:.0f} MB  {ZIPS[name].audience}\n")
    sys.stdout.write(f"{(options.out / INDEX).resolve().as_uri()}  all of them, as a repository for Blender\n")
    return 0


def build_addon(names: Sequence[str], *, out: Path, cache: Path) -> dict[str, Path]:
    """Write zips, by keys of `ZIPS`, our own wheel, their lists of components and the index; return the zips' paths.

    Raise BuildError if a wheel cannot be downloaded or has another SHA-256, or the version numbers disagree.
    """
    text = (ADDON / MANIFEST).read_text(encoding="utf-8")
    version = tomllib.loads(text)["version"]
    own_wheel = build_own_wheel(version, cache)
    build = own_wheel.name.split("-")[1]
    text = re.sub(rf'(^version = "|/crfnet-){re.escape(version)}(?=["-])', rf"\g<1>{build}", text, flags=re.MULTILINE)
    out.mkdir(parents=True, exist_ok=True)
    zips = {
        name: out / f"{tomllib.loads(text)['id']}-{version}-{name.replace('-', '_')}.zip"
        for name in ZIPS
        if name in names
    }
    for name, path in zips.items():
        manifest = platform_manifest(text, ZIPS[name])
        wheel_names = [Path(wheel).name for wheel in tomllib.loads(manifest)["wheels"]]
        wheels = [own_wheel if each == own_wheel.name else fetch_wheel(each, cache) for each in wheel_names]
        contents = {file.relative_to(ADDON).as_posix(): file.read_bytes() for file in shipped_files()}
        contents |= {f"wheels/{wheel.name}": wheel.read_bytes() for wheel in wheels}
        write_zip(path, contents | {MANIFEST: manifest.encode()})
        write_sbom(path, wheels)
    shutil.copyfile(own_wheel, out / own_wheel.name)
    write_sbom(out / own_wheel.name, [])
    write_index(out / INDEX, zips)
    return zips


def shipped_files() -> list[Path]:
    """Return the files of this folder that go into every zip; the manifest, which differs, is not among them."""
    return sorted(path for pattern in SHIPPED for path in ADDON.glob(pattern) if path != Path(__file__).resolve())


def platform_manifest(text: str, wanted: Zip) -> str:
    """Return the text of the manifest with only one platform and its wheels."""
    tags = re.compile(rf".*-(any|({'|'.join(wanted.pythons)})-\w+-{wanted.tag})\.whl")
    wheels = list(filter(tags.fullmatch, tomllib.loads(text)["wheels"]))
    for key, values in (("platforms", [wanted.platform]), ("wheels", wheels)):
        lines = "".join(f"    {json.dumps(value)},\n" for value in values)
        text, count = re.subn(rf"^{key} = \[\n.*?^\]$", f"{key} = [\n{lines}]", text, flags=re.MULTILINE | re.DOTALL)
        if count != 1:
            raise BuildError(f"{MANIFEST}: needs one list `{key}` with one line per entry, found {count}")
    return text


def build_own_wheel(version: str, cache: Path) -> Path:
    """Build the wheel that holds `crfnet_core` and `crfnet` in the folder of the downloads, and return its path.

    Its version, and the add-on's, end in a hash of all sources, such as 0.1.0+h1f3a5b7c: Blender keeps an installed
    wheel if another of the same name and version comes with a newer zip, and offers no update to the same version.
    Blender ignores the dependencies of the `crfnet` command, which the wheel declares.
    """
    fetch_wheel(next(name for name in _expected_hashes() if name.startswith("setuptools-")), cache)
    with tempfile.TemporaryDirectory() as folder:
        source, out = Path(folder, "source"), Path(folder, "out")
        source.mkdir()
        for name in SOURCES:
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
            info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))  # the earliest date
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
    _write_json(path.with_name(f"{path.name}.cdx.json"), document)


def write_index(path: Path, zips: Mapping[str, Path]) -> None:
    """Write the index of a folder as Blender's own `server-generate` does, from the manifests in the zips.

    Blender takes the first zip that fits, so each is offered to the versions of Python that none before it is for.
    """
    data: list[dict[str, Any]] = []
    taken: set[tuple[str, str]] = set()
    for name, archive in zips.items():
        with zipfile.ZipFile(archive) as opened:
            manifest = tomllib.loads(opened.read(MANIFEST).decode())
        offers = [(ZIPS[name].platform, f"3.{tag[3:]}") for tag in ZIPS[name].pythons]
        entry = {key: value for key, value in manifest.items() if key != "wheels"}
        entry["python_versions"] = [python for platform, python in offers if (platform, python) not in taken]
        entry["archive_url"] = f"./{quote(archive.name)}"
        entry["archive_size"] = archive.stat().st_size
        entry["archive_hash"] = f"sha256:{_sha256(archive)}"
        taken.update(offers)
        data.append(entry)
    _write_json(path, {"version": "v1", "blocklist": [], "data": data})


def _write_json(path: Path, document: Mapping[str, Any]) -> None:
    """Write a JSON file; a reader of the folder sees the earlier one or all of this."""
    temporary = path.with_name(f".{path.name}")
    temporary.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8", newline="\n")
    temporary.replace(path)


def _component(wheel: Path) -> dict[str, object]:
    """Return the component of a wheel: its name, version, package URL and SHA-256."""
    name, version = wheel.name.split("-")[:2]
    project = name.replace("_", "-").lower()
    purl = f"pkg:pypi/{project}@{quote(version)}?file_name={quote(wheel.name)}"
    names = {"type": "library", "name": project, "version": version, "purl": purl, "bom-ref": purl}
    return {**names, "hashes": _hashes(wheel)}


def _hashes(path: Path) -> list[dict[str, str]]:
    """Return the entry of a component with the SHA-256 of its file."""
    return [{"alg": "SHA-256", "content": _sha256(path)}]


def _expected_hashes() -> dict[str, str]:
    """Return the SHA-256 of every wheel that may be downloaded, by the name of the wheel."""
    lines = (ADDON / "wheels.sha256").read_text(encoding="utf-8").splitlines()
    return {name: digest for digest, name in map(str.split, lines)}


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
    """Copy a file, or a folder without the bytecode that Python leaves in it, into a folder that is there."""
    if source.is_dir():
        shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
    else:
        shutil.copyfile(source, target)


if __name__ == "__main__":
    sys.exit(main())

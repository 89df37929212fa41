"""The manifest of the extension, and the builder of its zips; without Blender."""

import hashlib
import json
import os
import re
import subprocess
import sys
import tomllib

import pytest

from blender_addon import build


@pytest.fixture(scope="module")
def manifest_text(root):
    return (root / "blender_addon" / "blender_manifest.toml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def manifest(manifest_text):
    return tomllib.loads(manifest_text)


@pytest.fixture(scope="module")
def hashes(root):
    lines = (root / "blender_addon" / "wheels.sha256").read_text(encoding="utf-8").splitlines()
    return {name: digest for digest, name in map(str.split, lines)}


def names(wheels):
    return {wheel.removeprefix("./wheels/") for wheel in wheels}


def pythons(wheels):
    """The versions of Python that a project's wheels are for, by the project."""
    projects = {name.split("-")[0] for name in names(wheels)}
    return {each: sorted(name.split("-")[2] for name in names(wheels) if name.startswith(each)) for each in projects}


def test_the_version_is_the_projects(root, manifest):
    version = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert manifest["version"] == version
    assert f"crfnet-{version}-py3-none-any.whl" in names(manifest["wheels"])


def test_every_wheel_has_its_hash(manifest, hashes):
    ours = {f"crfnet-{manifest['version']}-py3-none-any.whl"}
    builds_ours = {name for name in hashes if name.startswith("setuptools-")}
    assert names(manifest["wheels"]) - ours == set(hashes) - builds_ours
    assert len(builds_ours) == 1
    assert all(re.fullmatch("[0-9a-f]{64}", digest) for digest in hashes.values())


def test_every_wheel_of_the_manifest_is_in_a_zip(manifest, manifest_text):
    built = [tomllib.loads(build.platform_manifest(manifest_text, each)) for each in build.ZIPS.values()]
    for key in ("platforms", "wheels"):
        assert set().union(*(inside[key] for inside in built)) == set(manifest[key])


@pytest.mark.parametrize("name", build.ZIPS)
def test_a_zip_has_the_wheels_of_its_platform_and_its_pythons(manifest, manifest_text, name):
    inside = tomllib.loads(build.platform_manifest(manifest_text, build.ZIPS[name]))
    assert inside == manifest | {"platforms": [build.ZIPS[name].platform], "wheels": inside["wheels"]}
    compiled = {key: list(build.ZIPS[name].pythons) for key in ("onnxruntime", "pi_heif", "pillow")}
    assert pythons(inside["wheels"]) == {"crfnet": ["py3"], "platformdirs": ["py3"], **compiled}
    tags = {wheel.split("-")[-1].split("_")[0] for wheel in inside["wheels"]}
    assert tags == {"any.whl", {"linux": "manylinux", "macos": "macosx", "windows": "win"}[name.partition("-")[0]]}


def test_the_readme_says_for_whom_each_zip_is(root):
    readme = (root / "blender_addon" / "README.md").read_text(encoding="utf-8")
    for name, each in build.ZIPS.items():
        assert f"| `crf_response-<version>-{name.replace('-', '_')}.zip` | {each.audience} |" in readme


def test_a_zip_and_a_wheel_have_their_list_of_components(tmp_path):
    (tmp_path / "a.zip").write_bytes(b"zip")
    (tmp_path / "pi_heif-1.1.0+ab-cp311-cp311-win_amd64.whl").write_bytes(b"wheel")
    wheel = next(tmp_path.glob("*.whl"))
    build.write_sbom(tmp_path / "a.zip", [wheel])
    build.write_sbom(wheel, [])
    bom = json.loads((tmp_path / "a.zip.cdx.json").read_text())
    assert (bom["bomFormat"], bom["specVersion"]) == ("CycloneDX", "1.5")
    assert bom["metadata"]["component"]["hashes"][0]["content"] == hashlib.sha256(b"zip").hexdigest()
    (component,) = bom["components"]
    assert component["hashes"] == [{"alg": "SHA-256", "content": hashlib.sha256(b"wheel").hexdigest()}]
    assert component["purl"] == f"pkg:pypi/pi-heif@1.1.0%2Bab?file_name={wheel.name.replace('+', '%2B')}"
    assert json.loads((tmp_path / f"{wheel.name}.cdx.json").read_text())["metadata"]["component"] == component


def test_a_wheel_without_a_hash_is_refused(tmp_path):
    with pytest.raises(build.BuildError, match=r"^other-1-py3-none-any.whl: has no line in wheels.sha256"):
        build.fetch_wheel("other-1-py3-none-any.whl", tmp_path)


def test_a_download_with_another_hash_is_refused(hashes, tmp_path, monkeypatch):
    name = next(iter(hashes))
    monkeypatch.setattr(build, "_download", lambda name, folder: (folder / name).write_bytes(b"tampered with"))
    with pytest.raises(build.BuildError, match=f"{re.escape(name)}: the download has SHA-256"):
        build.fetch_wheel(name, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_file_in_the_cache_is_downloaded_again(tmp_path, monkeypatch):
    good = b"as published"
    monkeypatch.setattr(
        build, "_expected_hashes", lambda: {"one-1-py3-none-any.whl": build.hashlib.sha256(good).hexdigest()}
    )
    monkeypatch.setattr(build, "_download", lambda name, folder: (folder / name).write_bytes(good))
    (tmp_path / "one-1-py3-none-any.whl").write_bytes(b"cut sho")
    assert build.fetch_wheel("one-1-py3-none-any.whl", tmp_path).read_bytes() == good


def test_no_network_is_one_line(root, tmp_path):
    environment = {**os.environ, "PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(tmp_path), "PIP_CONFIG_FILE": os.devnull}
    command = [sys.executable, str(root / "blender_addon" / "build.py"), "--out", str(tmp_path / "out")]
    command += ["--cache", str(tmp_path / "cache")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert re.fullmatch(r"setuptools-\S+: cannot be downloaded; check the network \(pip: .*\)\n", done.stderr)
    assert not (tmp_path / "out").exists()


def test_the_build_of_our_wheel_changes_with_its_sources(tmp_path):
    digests = []
    for name, text in (("a/x.py", "1"), ("b/x.py", "1"), ("c/x.py", "2"), ("d/y.py", "2")):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text(text)
        digests.append(build._digest((tmp_path / name).parent))
    assert digests[0] == digests[1]
    assert len(set(digests)) == 3, "the content and the name count"
    assert all(digest.startswith("h") for digest in digests), "versions drop leading zeros of numbers"

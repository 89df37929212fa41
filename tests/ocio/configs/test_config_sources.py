"""Which config a user means: a file, a built-in name, $OCIO, or a Blender's."""

import pytest

from crfnet.configs.portable import portable_config
from crfnet.configs.sources import built_in_names, find_config, role_name
from crfnet.errors import ConfigError
from tests.helpers.folders import written
from tests.helpers.refusals import refusal_of


@pytest.fixture
def config(tmp_path):
    return written(tmp_path / "show.ocio", portable_config([]).serialize())


def blender(root, *, version="5.2", resources=""):
    """A Blender's files: the executable, and its config."""
    folder = root / resources / version / "datafiles" / "colormanagement"
    folder.mkdir(parents=True)
    return written(folder / "config.ocio", portable_config([]).serialize())


def executable(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    written(path, "a program").chmod(0o755)
    return path


def test_a_file_is_itself_and_so_is_a_link_and_a_folder_leads_to_it(config, tmp_path):
    result = find_config(str(config))
    assert (result.path, result.name) == (config, str(config))
    assert result.config.getName() == "crfnet"
    for link in (tmp_path / "link.ocio", tmp_path / "config.ocio"):
        link.symlink_to(config)
        assert find_config(str(link)).path == link
    assert find_config(str(tmp_path)).path == link


def test_built_in_configs_have_names():
    assert {"ocio://default", "ocio://cg-config-latest"} < set(built_in_names())
    for name in built_in_names():
        for result in (find_config(name), find_config(name.removeprefix("ocio://"))):
            assert (result.path, result.name) == (None, name)
            assert result.config.getColorSpace("ACES2065-1") is not None


@pytest.mark.parametrize("name", ["$OCIO", "${OCIO}", "%OCIO%"])
def test_the_environments_config(name, config, monkeypatch):
    monkeypatch.setenv("OCIO", str(config))
    assert find_config(name).path == config
    monkeypatch.setenv("OCIO", "ocio://cg-config-latest")
    assert find_config(name).path is None
    for value in ("", " $OCIO "):
        monkeypatch.setenv("OCIO", value)
        assert refusal_of(ConfigError, find_config, name).code == "config_variable_unset"


class TestBlender:
    def test_its_folder_where_the_newer_of_two_versions_counts(self, tmp_path):
        blender(tmp_path / "blender", version="4.5")
        path = blender(tmp_path / "blender")
        assert find_config(str(tmp_path / "blender")).path == path
        assert find_config(str(tmp_path / "blender" / "5.2")).path == path

    def test_its_executable(self, tmp_path, monkeypatch):
        path = blender(tmp_path / "blender")
        program = executable(tmp_path / "blender" / "blender")
        assert find_config(str(program)).path == path
        (tmp_path / "bin").mkdir()
        (tmp_path / "bin" / "blender").symlink_to(program)
        assert find_config(str(tmp_path / "bin" / "blender")).path == path
        monkeypatch.setenv("PATH", str(tmp_path / "bin"))
        assert find_config("blender").path == path

    def test_that_of_macos(self, tmp_path):
        path = blender(tmp_path / "Blender.app", resources="Contents/Resources")
        program = executable(tmp_path / "Blender.app" / "Contents" / "MacOS" / "Blender")
        assert find_config(str(tmp_path / "Blender.app")).path == path
        assert find_config(str(program)).path == path


@pytest.mark.parametrize(
    ("name", "code"),
    [
        *((name, "config_unknown") for name in ("nowhere", "ocio://nowhere")),
        *(("nowhere.ocio", "no_such_file"), ("a.ocioz", "config_archive")),
    ],
)
def test_anything_else_is_refused(name, code, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert refusal_of(ConfigError, find_config, name).code == code


def test_a_role_of_a_file_or_a_built_in_config_has_a_name_or_is_refused(config):
    assert role_name(str(config), "scene_linear") == "Linear Rec.709"
    assert role_name("ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1", "scene_linear") == "ACEScg"
    assert refusal_of(ConfigError, role_name, str(config), "nonsense").code == "role_absent"

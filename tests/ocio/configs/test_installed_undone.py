"""What is there after a config was put back, and after an installation or the way back has failed."""

from dataclasses import replace

import numpy as np
import pytest

from crfnet.configs import installed
from crfnet.configs.installation_record import FOLDER
from crfnet.configs.installed import install, installed_color_spaces, restore
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.portable import portable_config
from crfnet.defaults import CONFIG_NAME
from crfnet.errors import ConfigError
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import converted, disk_is_full, loaded
from tests.helpers.folders import listed, tree
from tests.helpers.looks import STUDIO, add

PLATE = "/shot/plate.png"
SPACE = PlateColorSpace("CRF plate", "plate.spi1d")
LUT = inverse_response_lut(ResponseCurve.gamma(2.2))
OTHER_LUT = inverse_response_lut(ResponseCurve.gamma(1.8))


def test_a_lut_that_the_earlier_config_names_stays(folder, base):
    install(folder, base, SPACE, LUT, plate=PLATE)
    mine = loaded(folder / CONFIG_NAME)
    space = mine.getColorSpace(SPACE.name)
    space.setName("mine")
    space.setFamily("mine")
    mine.addColorSpace(space)
    (folder / CONFIG_NAME).write_text(mine.serialize())
    install(folder, base, replace(SPACE, name="CRF b", lut_file="b.spi1d"), OTHER_LUT, plate="/shot/b.png")
    (folder / FOLDER / "notes.txt").write_text("mine")
    restore(folder)
    found = converted(loaded(folder / CONFIG_NAME), "mine", "scene_linear", [[0.5] * 3])
    np.testing.assert_allclose(found, LUT.apply([[0.5] * 3]), atol=1e-5)
    assert listed(folder / FOLDER) == ["notes.txt", "plate.spi1d"]


def test_a_file_that_was_no_config_comes_back(small_look, tmp_path):
    config = tmp_path / "show" / CONFIG_NAME
    config.parent.mkdir()
    config.write_text("no config")
    add(STUDIO, small_look, config, overwrite=True)
    restore(config.parent)
    assert tree(config.parent) == {CONFIG_NAME: b"no config"}


def test_a_failure_to_restore_can_be_repeated(folder, base, monkeypatch):
    install(folder, base, SPACE, LUT, plate=PLATE)
    (folder / CONFIG_NAME).write_text((folder / CONFIG_NAME).read_text() + "\n# mine\n")
    install(folder, base, SPACE, LUT, plate=PLATE)
    before = tree(folder)
    with monkeypatch.context() as patched:
        patched.setattr(installed, "write_config", disk_is_full)
        with pytest.raises(ConfigError, match="the disk is full"):
            restore(folder)
    assert tree(folder) == before
    restore(folder)
    assert installed_color_spaces(folder) == ()


def test_a_failure_leaves_links_and_permissions(folder, base, tmp_path, monkeypatch):
    folder.mkdir()
    config = tmp_path / "shared.ocio"
    config.write_text(portable_config([]).serialize())
    config.chmod(0o640)
    (folder / CONFIG_NAME).symlink_to(config)
    monkeypatch.setattr(installed, "write_record", disk_is_full)
    with pytest.raises(ConfigError, match="the disk is full"):
        install(folder, base, SPACE, LUT, plate=PLATE)
    assert (folder / CONFIG_NAME).is_symlink()
    assert config.stat().st_mode & 0o777 == 0o640
    assert listed(folder) == [CONFIG_NAME]


@pytest.mark.parametrize("step", ["write_config", "write_record"])
@pytest.mark.parametrize("is_changed", [False, True])
def test_a_failure_leaves_the_earlier_lut_and_config(folder, base, monkeypatch, step, is_changed):
    install(folder, base, SPACE, LUT, plate=PLATE)
    if is_changed:
        (folder / CONFIG_NAME).write_text((folder / CONFIG_NAME).read_text() + "\n# mine\n")
    before = tree(folder)
    monkeypatch.setattr(installed, step, disk_is_full)
    with pytest.raises(ConfigError, match="the disk is full"):
        install(folder, base, SPACE, OTHER_LUT, plate=PLATE)
    assert tree(folder) == before

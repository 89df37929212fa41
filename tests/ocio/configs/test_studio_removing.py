"""Plates are taken out of somebody's config, and it is as it was."""

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.installed import install, restore
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.portable import portable_config
from crfnet.configs.studio import removal
from crfnet.configs.studio.plates import plates_in_config
from crfnet.configs.studio.removal import remove_plates
from crfnet.configs.studio.sources import find_config
from crfnet.errors import ConfigError
from tests.helpers.configs import converted, disk_is_full, loaded
from tests.helpers.folders import listed, tree
from tests.helpers.looks import LUT, NAME, OTHER_LUT, STUDIO, add, all_names, write_look


class TestRemoving:
    def test_the_config_comes_back_byte_for_byte(self, studio, small_look, tmp_path):
        before = tree(studio.parent)
        add(studio, small_look, has_views=True)
        add(studio, write_look(tmp_path / "two", ["b.jpg"]), has_views=True)
        remove_plates(find_config(str(studio)), ["crf PLATE01", "CRF b"])
        assert tree(studio.parent) == before

    def test_the_others_stay(self, studio, small_look, tmp_path, tolerance):
        add(studio, small_look, has_views=True)
        add(studio, write_look(tmp_path / "two", ["b.jpg"], lut=OTHER_LUT), has_views=True)
        done = remove_plates(find_config(str(studio)), [NAME])
        found = loaded(studio)
        assert [plate.name for plate in plates_in_config(found)] == ["CRF b"]
        assert NAME not in studio.read_text()
        assert done.backup is not None
        assert listed(studio.parent / "show_camera_response") == ["b.spi1d", "installed.json"]
        pixels = converted(found, "CRF b", "scene_linear", [[0.5] * 3])
        np.testing.assert_allclose(pixels, OTHER_LUT.apply([[0.5] * 3]), atol=tolerance.lut)

    def test_what_somebody_has_changed_since_stays_changed(self, studio, small_look):
        add(studio, small_look)
        config = loaded(studio)
        config.setRole("color_picking", "ACEScct")
        studio.write_text(config.serialize())
        remove_plates(find_config(str(studio)), [NAME])
        assert loaded(studio).getColorSpace("color_picking").getName() == "ACEScct"
        assert plates_in_config(loaded(studio)) == []

    def test_a_backup_with_plates_in_it_is_not_put_back(self, studio, small_look, tmp_path):
        add(studio, small_look)
        studio.write_text(studio.read_text() + "\n# mine\n")
        add(studio, write_look(tmp_path / "two", ["b.jpg"]))
        remove_plates(find_config(str(studio)), [NAME, "CRF b"])
        assert plates_in_config(loaded(studio)) == []

    @pytest.mark.parametrize("step", ["write_config", "write_record"])
    def test_a_failure_leaves_everything_as_it_was(self, studio, small_look, tmp_path, monkeypatch, step):
        add(studio, small_look)
        add(studio, write_look(tmp_path / "two", ["b.jpg"]))
        before = tree(studio.parent)

        monkeypatch.setattr(removal, step, disk_is_full)
        with pytest.raises(ConfigError, match="the disk is full"):
            remove_plates(find_config(str(studio)), [NAME])
        assert tree(studio.parent) == before

    def test_a_config_that_was_made_for_the_plates_stays(self, small_look, tmp_path):
        add(STUDIO, small_look, tmp_path / "show" / "config.ocio", has_views=True)
        remove_plates(find_config(str(tmp_path / "show")), [NAME])
        assert all_names(loaded(tmp_path / "show" / "config.ocio")) == all_names(
            OCIO.Config.CreateFromBuiltinConfig(STUDIO)
        )
        assert listed(tmp_path / "show") == ["config.ocio"]

    @pytest.mark.parametrize("name", ["CRF nothing", "film", ""])
    def test_what_is_no_plate_is_refused(self, studio, small_look, name):
        add(studio, small_look)
        before = tree(studio.parent)
        with pytest.raises(ConfigError, match=r"has no plate .*; its plates are: CRF plate01"):
            remove_plates(find_config(str(studio)), [NAME, name])
        assert tree(studio.parent) == before


def test_the_add_on_and_the_command_share_a_config(small_look, tmp_path):
    """Both keep their record in the same place, so each can take out what the other has put in."""
    program, user = tmp_path / "program.ocio", tmp_path / "colormanagement"
    program.write_text(portable_config([]).serialize())
    install(user, program, PlateColorSpace("CRF sky", "sky.spi1d"), OTHER_LUT, plate="/sky.png")
    add(user, small_look, has_views=True)
    assert [plate.name for plate in plates_in_config(loaded(user / "config.ocio"))] == ["CRF sky", NAME]
    install(user, program, PlateColorSpace("CRF sky", "sky.spi1d"), LUT, plate="/sky.png")
    remove_plates(find_config(str(user)), [NAME])
    assert [plate.name for plate in plates_in_config(loaded(user / "config.ocio"))] == ["CRF sky"]
    assert restore(user).is_removed

"""Plates in somebody's config: everything else stays, and the same again changes nothing."""

import shutil

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.plate_views import view_names
from crfnet.configs.reference_space import REC709_TO_AP0
from crfnet.configs.studio import additions
from crfnet.configs.studio.aces_check import check_in_ap0
from crfnet.configs.studio.plates import plates_in_config
from crfnet.errors import ConfigError
from crfnet_core.colorimetry import ADOBE_RGB, AP0, DISPLAY_P3, PROPHOTO, conversion_matrix
from tests.helpers.configs import converted, disk_is_full, loaded
from tests.helpers.folders import listed, tree
from tests.helpers.looks import LUT, NAME, OTHER_LUT, STUDIO, add, all_names, space_of, write_look

BUILT_IN = [entry[0] for entry in OCIO.BuiltinConfigRegistry().getBuiltinConfigs()]


@pytest.mark.parametrize("name", BUILT_IN)
class TestBuiltIn:
    def test_all_of_it_is_kept_and_the_plate_is_right_in_aces(self, name, small_look, tmp_path):
        done = add(name, small_look, tmp_path / "show" / "config.ocio", has_views=True)
        found = loaded(done.config)
        assert all_names(found) == all_names(OCIO.Config.CreateFromBuiltinConfig(name))
        pixels = np.random.default_rng(0).uniform(0, 1, (500, 3)).astype(np.float32)
        expected = LUT.apply(pixels) @ np.transpose(REC709_TO_AP0)
        np.testing.assert_allclose(converted(found, NAME, "aces_interchange", pixels), expected, atol=1e-5)

    def test_only_the_plates_own_files_change_their_space(self, name, small_look, tmp_path):
        base = OCIO.Config.CreateFromBuiltinConfig(name)
        found = loaded(add(name, small_look, tmp_path / "show.ocio").config)
        assert [space_of(found, path) for path in ("/a/plate01.jpg", "PLATE01.JPG")] == [NAME] * 2
        for path in ("/a/plate01_linear.exr", "Plate01_Linear.EXR"):
            assert found.getColorSpace(space_of(found, path)).getName().startswith("Linear Rec.709")
        for path in ("b.exr", "x/b.jpg", "plate01.png", "plate02.jpg", "aplate01.jpg", "plate01.jpg.exr", "b.mov"):
            assert space_of(found, path) == space_of(base, path)


@pytest.mark.parametrize("primaries", [DISPLAY_P3, ADOBE_RGB, PROPHOTO])
def test_other_primaries_are_right_in_aces(primaries, tmp_path):
    folder = write_look(tmp_path / "look", primaries=primaries, exposure=1.5)
    found = loaded(add(STUDIO, folder, tmp_path / "show.ocio").config)
    pixels = np.random.default_rng(0).uniform(0, 1, (500, 3)).astype(np.float32)
    expected = 2**1.5 * LUT.apply(pixels) @ conversion_matrix(primaries, AP0).T
    np.testing.assert_allclose(converted(found, NAME, "aces_interchange", pixels), expected, atol=3e-5)


class TestAddingInPlace:
    def test_the_studios_config_keeps_everything(self, studio, small_look, tolerance):
        before, text = loaded(studio), studio.read_bytes()
        done = add(studio, small_look)
        after = loaded(studio)
        assert (done.config, done.is_changed, done.backup.read_bytes()) == (studio, True, text)
        assert all_names(after) == all_names(before)
        assert list(after.getSearchPaths()) == ["luts", "$SHOW/luts", "."]
        assert after.getEnvironmentVarDefault("SHOW") == "/shows/a"
        assert space_of(after, "a.dpx") == "film"
        film = converted(after, "film", "scene_linear", [[0.5] * 3])
        np.testing.assert_allclose(film, OTHER_LUT.apply([[0.5] * 3]), atol=tolerance.lut)
        assert listed(studio.parent) == [
            "luts",
            "show.before-camera-response.ocio",
            "show.ocio",
            "show_camera_response",
        ]

    def test_a_plate_that_the_base_holds_already_is_replaced_in_a_new_config(self, studio, small_look, tmp_path):
        add(studio, small_look)
        (tmp_path / "new").mkdir()
        done = add(studio, small_look, tmp_path / "new" / "show.ocio")
        found = loaded(done.config)
        assert [plate.name for plate in plates_in_config(found)] == [NAME]
        assert plates_in_config(found)[0].lut_file.startswith("show_camera_response/")
        assert space_of(found, "plate01.jpg") == NAME
        before = tree(tmp_path)
        assert not add(studio, small_look, done.config).is_changed
        assert not add(done.config, small_look).is_changed
        assert tree(tmp_path) == before

    def test_the_same_again_changes_no_byte(self, studio, small_look):
        add(studio, small_look, has_views=True)
        before = tree(studio.parent)
        done = add(studio, small_look)
        assert (done.is_changed, done.backup) == (False, None)
        assert tree(studio.parent) == before

    def test_a_plate_among_others_is_there_already(self, studio, small_look, tmp_path):
        add(studio, small_look, has_views=True)
        add(studio, write_look(tmp_path / "two", ["b.jpg"], lut=OTHER_LUT), has_views=True)
        before = tree(studio.parent)
        assert not add(studio, small_look, has_views=True).is_changed
        assert tree(studio.parent) == before

    def test_a_new_estimate_replaces_the_old_one(self, studio, small_look, tolerance):
        add(studio, small_look, has_views=True)
        write_look(small_look, lut=OTHER_LUT, exposure=1)
        done = add(studio, small_look)
        assert [plate.name for plate in plates_in_config(loaded(studio))] == [NAME]
        assert done.plates[0].exposure == 1
        assert done.plates[0].views == view_names(NAME)
        found = converted(loaded(studio), NAME, "scene_linear", [[0.5] * 3])
        np.testing.assert_allclose(found, 2 * OTHER_LUT.apply([[0.5] * 3]), atol=tolerance.plate)

    def test_only_the_lut_may_be_new(self, studio, small_look, tolerance):
        add(studio, small_look)
        text = studio.read_bytes()
        write_look(small_look, lut=OTHER_LUT)
        assert add(studio, small_look).is_changed
        assert studio.read_bytes() == text
        found = converted(loaded(studio), NAME, "scene_linear", [[0.5] * 3])
        np.testing.assert_allclose(found, OTHER_LUT.apply([[0.5] * 3]), atol=tolerance.lut)

    def test_two_plates_of_one_name_keep_their_responses(self, studio, small_look, tmp_path, tolerance):
        add(studio, small_look)
        done = add(studio, write_look(tmp_path / "night", lut=OTHER_LUT))
        assert [plate.name for plate in done.plates] == ["CRF plate01 (night)"]
        for name, lut in ((NAME, LUT), ("CRF plate01 (night)", OTHER_LUT)):
            found = converted(loaded(studio), name, "scene_linear", [[0.5] * 3])
            np.testing.assert_allclose(found, lut.apply([[0.5] * 3]), atol=tolerance.lut)

    def test_two_configs_of_one_folder_keep_their_luts(self, studio, small_look, tmp_path, tolerance):
        other = shutil.copy(studio, studio.with_name("other.ocio"))
        add(studio, small_look)
        add(other, write_look(tmp_path / "x" / "look", lut=OTHER_LUT))
        found = converted(loaded(studio), NAME, "scene_linear", [[0.5] * 3])
        np.testing.assert_allclose(found, LUT.apply([[0.5] * 3]), atol=tolerance.lut)

    def test_a_name_of_the_studios_own_is_left_to_it(self, studio, small_look):
        config = loaded(studio)
        config.addColorSpace(OCIO.ColorSpace(name=NAME))
        studio.write_text(config.serialize())
        before = tree(studio.parent)
        with pytest.raises(ConfigError, match="the config uses this name for 'CRF plate01'; choose another name"):
            add(studio, small_look)
        assert tree(studio.parent) == before

    def test_a_config_whose_aces_is_wrong_is_left_as_it_is(self, studio, small_look):
        config = loaded(studio)
        config.setRole("aces_interchange", "ACEScg")
        studio.write_text(config.serialize())
        before = tree(studio.parent)
        with pytest.raises(ConfigError, match=r"CRF plate01: differs by 0\.\d+ in ACES2065-1; .* mend it"):
            add(studio, small_look)
        assert tree(studio.parent) == before

    def test_a_read_only_config_needs_another_place(self, studio, small_look, monkeypatch, tmp_path):
        monkeypatch.setattr("os.access", lambda path, mode: path not in (studio, studio.parent))
        with pytest.raises(ConfigError, match=r"show\.ocio: is read-only; add --out FILE\.ocio"):
            add(studio, small_look)
        assert add(studio, small_look, tmp_path / "out" / "show.ocio").is_changed


class TestAddingElsewhere:
    def test_the_source_stays_and_its_files_are_found(self, studio, small_look, tmp_path, tolerance):
        before = tree(studio.parent)
        done = add(studio, small_look, tmp_path / "new" / "show.ocio")
        assert tree(studio.parent) == before
        assert list(loaded(done.config).getSearchPaths()) == [str(studio.parent / "luts"), "$SHOW/luts", "."]
        film = converted(loaded(done.config), "film", "scene_linear", [[0.5] * 3])
        np.testing.assert_allclose(film, OTHER_LUT.apply([[0.5] * 3]), atol=tolerance.lut)

    def test_a_built_in_config_needs_a_place(self, small_look):
        with pytest.raises(ConfigError, match=r"is built into OpenColorIO and cannot be changed; add --out FILE\.ocio"):
            add(STUDIO, small_look)

    def test_another_config_is_replaced_only_when_asked(self, small_look, tmp_path):
        out = tmp_path / "show.ocio"
        out.write_text("mine")
        with pytest.raises(ConfigError, match=r"show\.ocio: exists and differs; .*--overwrite"):
            add(STUDIO, small_look, out)
        assert listed(tmp_path) == ["look", "show.ocio"]
        done = add(STUDIO, small_look, out, overwrite=True)
        assert done.backup.read_text() == "mine"

    @pytest.mark.parametrize("step", ["check_in_ap0", "write_config", "write_record"])
    def test_a_failure_leaves_everything_as_it_was(self, studio, small_look, monkeypatch, step):
        add(studio, small_look)
        studio.write_text(studio.read_text() + "\n# mine\n")
        before = tree(studio.parent)

        monkeypatch.setattr(additions, step, disk_is_full)
        with pytest.raises(ConfigError, match="the disk is full"):
            add(studio, write_look(small_look, lut=OTHER_LUT))
        assert tree(studio.parent) == before

    def test_the_same_again_changes_no_byte(self, small_look, tmp_path):
        add(STUDIO, small_look, tmp_path / "show" / "config.ocio", has_views=True)
        before = tree(tmp_path / "show")
        assert not add(STUDIO, small_look, tmp_path / "show" / "config.ocio", has_views=True).is_changed
        assert tree(tmp_path / "show") == before

    def test_the_folder_can_be_moved(self, small_look, tmp_path, tolerance):
        add(STUDIO, small_look, tmp_path / "show" / "config.ocio")
        (tmp_path / "show").rename(tmp_path / "elsewhere")
        found = converted(loaded(tmp_path / "elsewhere" / "config.ocio"), NAME, "lin_rec709_scene", [[0.5] * 3])
        np.testing.assert_allclose(found, LUT.apply([[0.5] * 3]), atol=tolerance.plate)


def test_a_config_without_aces_is_not_checked_and_says_so(tmp_path):
    notes = check_in_ap0(OCIO.Config.CreateRaw(), tmp_path, {})
    assert notes == ["not checked in ACES2065-1: the config has no role aces_interchange"]

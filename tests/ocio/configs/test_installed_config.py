"""A plate's colour space in the config that a program reads at its start, and the way back."""

import json
from dataclasses import replace

import numpy as np
import pytest

from crfnet.configs import installed
from crfnet.configs.installation_record import FOLDER, RECORD_NAME
from crfnet.configs.installed import install, installed_color_spaces, restore, uninstall
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.portable import portable_config
from crfnet.defaults import CONFIG_NAME
from crfnet.errors import ConfigError, PlateError
from crfnet.luts.files import read_lut, write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import converted, loaded, rule_names
from tests.helpers.folders import listed, tree

PLATE = "/shot/plate.png"
SPACE = PlateColorSpace("CRF plate", "plate.spi1d", file_pattern="plate.*")
LUT = inverse_response_lut(ResponseCurve.gamma(2.2))
OTHER_LUT = inverse_response_lut(ResponseCurve.gamma(1.8))


def irradiance(config, brightness, space="CRF plate"):
    """Gray brightnesses, shape (N,), converted by a config file."""
    pixels = np.repeat(np.float32(brightness)[:, None], 3, axis=1)
    return converted(loaded(config), space, "scene_linear", pixels)[:, 0]


def space_names(config):
    return [space.getName() for space in loaded(config).getColorSpaces()]


def test_a_new_folder_is_complete_in_itself(folder, base, tolerance):
    before = tree(base.parent)
    done = install(folder, base, SPACE, LUT, plate=PLATE)
    assert (done.config, done.color_space) == (folder / CONFIG_NAME, "CRF plate")
    assert (done.is_changed, done.backup) == (True, None)
    assert set(tree(folder)) == {*(CONFIG_NAME, "luts/film.spi1d", f"{FOLDER}/plate.spi1d", f"{FOLDER}/{RECORD_NAME}")}
    assert list(loaded(done.config).getSearchPaths()) == ["luts", "."]
    values = np.linspace(0, 1, 99)
    np.testing.assert_allclose(irradiance(done.config, values), LUT.apply(values), atol=tolerance.lut)
    assert tree(base.parent) == before


def test_restoring_leaves_no_folder(folder, base):
    """Blender takes an empty folder for a config that cannot be read, and runs without AgX."""
    install(folder, base, SPACE, LUT, plate=PLATE)
    done = restore(folder)
    assert (done.config, done.is_removed) == (folder / CONFIG_NAME, True)
    assert not folder.exists()


def test_an_empty_folder_of_an_earlier_version_goes(folder):
    folder.mkdir()
    assert restore(folder).is_removed
    assert not folder.exists()


def test_no_file_of_another_project_gets_the_space(folder, base):
    """The config holds for every project, and file rules know a file by its name alone."""
    done = install(folder, base, SPACE, LUT, plate=PLATE)
    assert rule_names(loaded(done.config)) == rule_names(loaded(base))
    assert loaded(done.config).getColorSpaceFromFilepath("/elsewhere/plate.png")[0] != "CRF plate"


def test_the_rules_of_earlier_versions_go(folder, base):
    folder.mkdir()
    config = portable_config([SPACE, PlateColorSpace("CRF 0001", "0001.spi1d", file_pattern="*.jpg")])
    rules = config.getFileRules()
    rules.insertRule(0, "mine", "sRGB", r".*\.tif")
    config.setFileRules(rules)
    (folder / CONFIG_NAME).write_text(config.serialize())
    write_lut(folder / "0001.spi1d", LUT)
    done = install(folder, base, SPACE, LUT, plate=PLATE)
    assert rule_names(loaded(done.config)) == ["mine", *rule_names(loaded(base))]
    assert "CRF 0001" in space_names(done.config)


def test_two_plates_of_one_name_keep_their_responses(folder, base, tolerance):
    first = install(folder, base, SPACE, LUT, plate="/a/plate.png", hint="a")
    aliased = replace(SPACE, aliases=("crf_plate",))
    second = install(folder, base, aliased, OTHER_LUT, plate="/b/plate.png", hint="b")
    third = install(folder, base, SPACE, OTHER_LUT, plate="/c/b/plate.png", hint="b")
    assert [done.color_space for done in (first, second, third)] == ["CRF plate", "CRF plate (b)", "CRF plate (b 2)"]
    for done, lut in ((first, LUT), (second, OTHER_LUT), (third, OTHER_LUT)):
        found = irradiance(folder / CONFIG_NAME, [0.5], done.color_space)
        np.testing.assert_allclose(found, lut.apply([0.5]), atol=tolerance.lut)
    assert loaded(folder / CONFIG_NAME).getColorSpace("crf_plate_b") is not None
    again = install(folder, base, SPACE, LUT, plate="/b/plate.png", hint="b")
    assert again.color_space == "CRF plate (b)"
    np.testing.assert_allclose(irradiance(again.config, [0.5], "CRF plate (b)"), LUT.apply([0.5]), atol=tolerance.lut)


def test_a_space_of_an_earlier_version_is_left_to_its_plate(folder, base):
    """Its record does not say which plate it belongs to."""
    install(folder, base, SPACE, LUT, plate=PLATE)
    record = folder / FOLDER / RECORD_NAME
    entries = json.loads(record.read_text())
    del entries["plates"]
    record.write_text(json.dumps(entries))
    assert install(folder, base, SPACE, OTHER_LUT, plate=PLATE).color_space == "CRF plate (2)"
    assert restore(folder).is_removed


def test_the_same_again_changes_nothing(folder, base):
    install(folder, base, SPACE, LUT, plate=PLATE)
    before = tree(folder)
    assert not install(folder, base, SPACE, LUT, plate=PLATE).is_changed
    assert tree(folder) == before


def test_another_response_of_the_same_plate_is_a_change(folder, base):
    install(folder, base, SPACE, LUT, plate=PLATE)
    assert install(folder, base, SPACE, OTHER_LUT, plate=PLATE).is_changed
    assert space_names(folder / CONFIG_NAME).count("CRF plate") == 1
    np.testing.assert_array_equal(read_lut(folder / FOLDER / "plate.spi1d").values, OTHER_LUT.values)


def test_several_plates_share_the_config(folder, base, tolerance):
    install(folder, base, SPACE, LUT, plate=PLATE)
    install(folder, base, PlateColorSpace("CRF other", "other.spi1d"), OTHER_LUT, plate="/shot/other.png")
    config = folder / CONFIG_NAME
    np.testing.assert_allclose(irradiance(config, [0.5]), LUT.apply([0.5]), atol=tolerance.lut)
    np.testing.assert_allclose(irradiance(config, [0.5], "CRF other"), OTHER_LUT.apply([0.5]), atol=tolerance.lut)
    assert restore(folder).is_removed
    assert not folder.exists()


def test_a_config_of_somebody_else_is_kept_and_restored(folder, base):
    folder.mkdir()
    (folder / CONFIG_NAME).write_text(portable_config([]).serialize() + "\n# mine\n")
    before = tree(folder)
    done = install(folder, base, SPACE, LUT, plate=PLATE)
    assert done.backup is not None
    assert done.backup.read_bytes() == before[CONFIG_NAME]
    assert install(folder, base, SPACE, OTHER_LUT, plate=PLATE).backup == done.backup
    assert not (folder / "luts").exists(), "the folders of the base are not needed"
    assert not restore(folder).is_removed
    assert tree(folder) == before, "our LUT is gone, too"
    with pytest.raises(ConfigError, match="there is nothing to restore"):
        restore(folder)


def test_a_config_changed_since_gets_a_backup_of_its_own(folder, base):
    install(folder, base, SPACE, LUT, plate=PLATE)
    config = folder / CONFIG_NAME
    config.write_text(config.read_text() + "\n# mine\n")
    with pytest.raises(ConfigError, match="changed by another program"):
        restore(folder)
    mine = config.read_bytes()
    first = install(folder, base, SPACE, LUT, plate=PLATE).backup
    assert first.read_bytes() == mine
    config.write_text(config.read_text() + "\n# mine again\n")
    second = install(folder, base, SPACE, LUT, plate=PLATE).backup
    assert second != first
    assert second.read_bytes().endswith(b"# mine again\n")


def test_a_config_that_was_ours_and_was_changed_comes_back_without_our_spaces(folder, base):
    install(folder, base, SPACE, LUT, plate=PLATE)
    changed = loaded(folder / CONFIG_NAME)
    changed.setDescription("mine")
    (folder / CONFIG_NAME).write_text(changed.serialize())
    install(folder, base, SPACE, OTHER_LUT, plate=PLATE)
    uninstall(folder, SPACE.name)
    restored = loaded(folder / CONFIG_NAME)
    assert restored.getDescription() == "mine"
    assert restored.getColorSpace(SPACE.name) is None
    assert installed_color_spaces(folder) == ()
    assert not (folder / FOLDER).exists()
    assert (folder / "luts").is_dir(), "the config needs the folders of its base"


@pytest.mark.parametrize("change", [None, {"folders": [5]}, {"backup": 5}, {"folders": [".."]}, {"backup": "../a"}])
def test_a_damaged_record_counts_as_none(folder, base, change):
    """And so does one that would have files removed or moved elsewhere."""
    install(folder, base, SPACE, LUT, plate=PLATE)
    record = folder / FOLDER / RECORD_NAME
    record.write_text("{}" if change is None else json.dumps(json.loads(record.read_text()) | change))
    with pytest.raises(ConfigError, match="there is nothing to restore"):
        restore(folder)
    assert install(folder, base, SPACE, LUT, plate=PLATE).backup is not None


def test_a_config_that_does_not_load_is_left_alone(folder, base):
    folder.mkdir()
    (folder / CONFIG_NAME).write_text("no config")
    with pytest.raises(ConfigError, match="refuses this config"):
        install(folder, base, SPACE, LUT, plate=PLATE)
    assert tree(folder) == {CONFIG_NAME: b"no config"}
    assert listed(folder) == [CONFIG_NAME]


def test_what_was_written_goes_again_after_a_failure(folder, base, monkeypatch):
    def fail(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(installed, "write_config", fail)
    with pytest.raises(KeyboardInterrupt):
        install(folder, base, SPACE, LUT, plate=PLATE)
    assert not folder.exists()


def test_a_name_that_the_config_uses_is_refused(folder, base):
    with pytest.raises(ConfigError, match="choose another name"):
        install(folder, base, PlateColorSpace("sRGB", "plate.spi1d"), LUT, plate=PLATE)
    assert not folder.exists()


def test_a_folder_that_cannot_be_made_is_refused(tmp_path, base):
    (tmp_path / "file").touch()
    with pytest.raises(PlateError, match="is not a folder"):
        install(tmp_path / "file" / "user", base, SPACE, LUT, plate=PLATE)


OTHER_SPACE = PlateColorSpace("CRF other", "other.spi1d", file_pattern="other.*", exposure=1.0)


def test_what_was_installed_is_listed_and_nothing_else(folder, base):
    assert installed_color_spaces(folder) == ()
    assert installed_color_spaces(base.parent) == ()
    install(folder, base, SPACE, LUT, plate=PLATE)
    install(folder, base, OTHER_SPACE, OTHER_LUT, plate="/shot/other.png")
    assert installed_color_spaces(folder) == ("CRF plate", "CRF other")


def test_one_color_space_is_taken_out_and_the_others_stay(folder, base, tolerance):
    install(folder, base, SPACE, LUT, plate=PLATE)
    alone = tree(folder)
    config = install(folder, base, OTHER_SPACE, OTHER_LUT, plate="/shot/other.png").config
    uninstall(folder, "CRF other")
    assert tree(folder).keys() == alone.keys()
    assert installed_color_spaces(folder) == ("CRF plate",)
    values = np.linspace(0, 1, 99)
    np.testing.assert_allclose(irradiance(config, values), LUT.apply(values), atol=tolerance.lut)
    uninstall(folder, "CRF plate")  # the last one
    assert not (folder / CONFIG_NAME).exists()
    assert not (folder / FOLDER).exists()


def test_the_earlier_config_is_back_after_the_last_was_taken_out(base):
    before = base.read_bytes()
    install(base.parent, base, SPACE, LUT, plate=PLATE)
    install(base.parent, base, OTHER_SPACE, OTHER_LUT, plate="/shot/other.png")
    uninstall(base.parent, "CRF plate")
    uninstall(base.parent, "CRF other")
    assert base.read_bytes() == before


def test_only_what_was_installed_can_be_taken_out(folder, base):
    config = install(folder, base, SPACE, LUT, plate=PLATE).config
    before = config.read_bytes()
    for name in ("lin_rec709_scene", "nothing"):
        with pytest.raises(ConfigError, match="has no installed colour space"):
            uninstall(folder, name)
    config.write_bytes(before + b"\n# mine\n")
    with pytest.raises(ConfigError, match="changed by another program"):
        uninstall(folder, "CRF plate")
    assert config.read_bytes() == before + b"\n# mine\n"

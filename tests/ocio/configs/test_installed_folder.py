"""The folder of a config that was installed: what is ours in it, and what the program's own config has beside it."""

import json
import re

import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.installation_record import FOLDER, RECORD_NAME
from crfnet.configs.installed import install, missing_color_spaces, restore
from crfnet.configs.portable import portable_config
from crfnet.defaults import CONFIG_NAME
from crfnet.errors import ConfigError
from tests.helpers.configs import loaded
from tests.helpers.folders import tree

from .test_installed_config import LUT, PLATE, SPACE


@pytest.mark.parametrize("name", ["mine.txt", "luts/mine.cube"])
def test_the_files_of_others_are_kept_and_named_before_anything_goes(folder, base, name):
    """Blender takes a folder without a config for the user's, too, and runs without AgX."""
    install(folder, base, SPACE, LUT, plate=PLATE)
    (folder / name).write_text("mine")
    before = tree(folder)
    with pytest.raises(ConfigError, match=f"{re.escape(name)}: came neither from us nor with the config; move it"):
        restore(folder)
    assert tree(folder) == before
    (folder / name).unlink()
    assert restore(folder).is_removed
    assert not folder.exists()


def test_a_record_of_an_earlier_version_takes_all_in_the_copied_folders_for_copied(folder, base):
    install(folder, base, SPACE, LUT, plate=PLATE)
    record = folder / FOLDER / RECORD_NAME
    record.write_text(
        json.dumps({key: value for key, value in json.loads(record.read_text()).items() if key != "files"})
    )
    assert restore(folder).is_removed
    assert not folder.exists()


def test_what_a_newer_version_of_the_program_adds_is_missing(folder, base, tmp_path):
    install(folder, base, SPACE, LUT, plate=PLATE)
    assert missing_color_spaces(folder, base) == ()
    newer = loaded(base)
    newer.addColorSpace(OCIO.ColorSpace(name="new in this version"))
    (tmp_path / "newer.ocio").write_text(newer.serialize())
    assert missing_color_spaces(folder, tmp_path / "newer.ocio") == ("new in this version",)
    restore(folder)
    assert missing_color_spaces(folder, tmp_path / "newer.ocio") == ()
    folder.mkdir()
    (folder / CONFIG_NAME).write_text(portable_config([]).serialize())  # the user's own
    install(folder, base, SPACE, LUT, plate=PLATE)
    assert missing_color_spaces(folder, tmp_path / "newer.ocio") == ()

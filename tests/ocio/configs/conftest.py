"""What several tests of configs need."""

import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.portable import portable_config
from crfnet.luts.files import write_lut
from tests.helpers.configs import LUT
from tests.helpers.folders import written
from tests.helpers.looks import OTHER_LUT, write_look


@pytest.fixture
def small_look(tmp_path):
    return write_look(tmp_path / "look")


@pytest.fixture
def folder(tmp_path):
    """A folder with the LUT of `SPACE`."""
    write_lut(tmp_path / "plate01.spi1d", LUT)
    return tmp_path


@pytest.fixture
def studio(tmp_path):
    """A studio's own config, with a folder of LUTs, an environment, comments and rules."""
    folder = tmp_path / "studio"
    (folder / "luts").mkdir(parents=True)
    write_lut(folder / "luts" / "film.spi1d", OTHER_LUT)
    config = portable_config([])
    config.clearSearchPaths()
    config.addSearchPath("luts")
    config.addSearchPath("$SHOW/luts")
    config.addEnvironmentVar("SHOW", "/shows/a")
    film = OCIO.FileTransform(src="film.spi1d", interpolation=OCIO.INTERP_LINEAR)
    config.addColorSpace(OCIO.ColorSpace(name="film", toReference=film))
    rules = config.getFileRules()
    rules.insertRule(0, "scans", "film", r".*\.dpx")
    config.setFileRules(rules)
    return written(folder / "show.ocio", "# the show's own config\n" + config.serialize())

import numpy as np
import pytest

from crfnet.movies.stream import LOG_TAGS
from crfnet_core.photograph.metadata.color_tags import TRANSFERS
from crfnet_core.photograph.recognition import COLOR_SPACES, LOG_CURVES
from crfnet_core.photograph.recognition.recognition import TAGGED_SPACES

#: The names of the curves in colour-science, which has no Blackmagic Film.
COLOUR_SCIENCE = {name: name for name in LOG_CURVES if name.startswith(("ARRI", "Canon"))} | {
    **{"Apple Log": "Apple Log Profile", "DJI D-Log": "D-Log", "Fujifilm F-Log": "F-Log", "Fujifilm F-Log2": "F-Log2"},
    **{"Nikon N-Log": "N-Log", "Panasonic V-Log": "V-Log", "RED Log3G10": "Log3G10"},
    **{"Sony S-Log2": "S-Log2", "Sony S-Log3": "S-Log3"},
}

REFLECTANCE = np.concatenate([[0, 0.001, 0.005, 0.012, 0.18, 0.327, 0.329, 0.9, 1], np.geomspace(2, 50, 9)])


@pytest.mark.parametrize("name", COLOUR_SCIENCE)
def test_the_curve_is_that_of_colour_science(name):
    colour = pytest.importorskip("colour", reason="colour-science comes with the test extra")
    expected = colour.log_encoding(REFLECTANCE, function=COLOUR_SCIENCE[name])
    np.testing.assert_allclose(LOG_CURVES[name](REFLECTANCE), expected, atol=2e-5)


@pytest.mark.parametrize("name", COLOR_SPACES)
def test_the_named_color_space_of_the_aces_config_undoes_the_curve(name):
    """OpenColorIO turns codes of gray back into reflectance: its matrices keep gray, or scale it by the white point."""
    ocio = pytest.importorskip("PyOpenColorIO")
    config = ocio.Config.CreateFromFile("ocio://studio-config-latest")
    to_linear = config.getProcessor(COLOR_SPACES[name], "ACES2065-1").getDefaultCPUProcessor()
    reflectance = np.array([0.02, 0.18, 0.9, 4.0, 0.001])
    linear = np.array([to_linear.applyRGB([code] * 3)[1] for code in LOG_CURVES[name](reflectance)])
    np.testing.assert_allclose(linear / linear[1], reflectance / 0.18, rtol=2e-3)
    assert linear[1] == pytest.approx(0.18, rel=0.02)


def test_every_tag_that_names_a_color_space_names_one_of_the_aces_config():
    ocio = pytest.importorskip("PyOpenColorIO")
    names = set(ocio.Config.CreateFromFile("ocio://studio-config-latest").getColorSpaceNames())
    assert set(TAGGED_SPACES.values()) <= names
    curves = {curve for marks in LOG_TAGS.values() for curve in marks.values()}
    assert set(TAGGED_SPACES) <= {*LOG_CURVES, *TRANSFERS.values(), *curves}
    assert curves <= {*LOG_CURVES, *TAGGED_SPACES}

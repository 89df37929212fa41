"""The picture of the exposure: it is drawn, and the photographed card equals the rendered one with gray at 0.18."""

import importlib.util

import numpy as np
import pytest

from crfnet.defaults import GRAY_BRIGHTNESS
from crfnet.luts.exposure import anchored_exposure
from crfnet_core.response.curve import ResponseCurve

pytest.importorskip("matplotlib")

LARGEST_PICTURE = 300_000


@pytest.fixture(scope="module")
def script(root):
    spec = importlib.util.spec_from_file_location("make_exposure_picture", root / "docs" / "make_exposure_picture.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_it_is_drawn(script, tmp_path):
    script.draw_exposure_picture(tmp_path / "pictures" / "exposure.jpg")
    assert 20_000 < (tmp_path / "pictures" / "exposure.jpg").stat().st_size < LARGEST_PICTURE
    assert script.PICTURE.stat().st_size < LARGEST_PICTURE


@pytest.mark.parametrize(("gray", "is_same"), [(None, False), (GRAY_BRIGHTNESS, True)])
def test_the_cards_are_equal_with_the_anchor_only(script, gray, is_same):
    curve = ResponseCurve.from_samples(np.linspace(0, 1, 1024) ** 0.37)
    light = curve.inverse(script.with_gray_card(np.full((200, 500, 3), 0.5, np.float32)))
    shown = script.displayed(script.with_rendered_objects(light * 2 ** anchored_exposure(curve, gray=gray)))
    photographed, rendered = (shown[-40, script.left_of(place) + 10] for place in (0, 1))
    np.testing.assert_allclose(rendered, 0.349, atol=0.002)
    assert (np.abs(photographed - rendered).max() < 1e-4) == is_same


def test_levels_are_printed(script, plate, capsys):
    script.print_levels(plate)
    assert capsys.readouterr().out.startswith("plate.jpg: +0.")

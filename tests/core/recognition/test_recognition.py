"""Log footage, limited range and tags: what is recognized, and what is left alone."""

import numpy as np
import pytest

from crfnet_core.metadata.color_tags import ColorTags
from crfnet_core.recognition import (
    Kind,
    Levels,
    is_limited_range,
    log_curves,
    log_factor,
    nearest_curves,
    recognize,
    tag_refusal,
)
from crfnet_core.recognition.log_footage import BLACK_FACTOR, HIGH_WHITE_FACTOR, LOW_WHITE_FACTOR
from tests.helpers.footage import log_picture, ordinary_picture, quantized


@pytest.mark.parametrize("name", log_curves())
def test_the_levels_of_log_footage_speak_for_log(name):
    assert log_factor(Levels.of(log_picture(name))) == pytest.approx(BLACK_FACTOR * LOW_WHITE_FACTOR)


def test_the_levels_of_an_ordinary_picture_say_nothing():
    assert log_factor(Levels.of(ordinary_picture())) == 1


def test_a_lifted_black_with_a_clipped_white_says_less():
    faded = quantized(0.1 + 0.9 * ordinary_picture().astype(float))
    assert log_factor(Levels.of(faded)) == pytest.approx(BLACK_FACTOR * HIGH_WHITE_FACTOR)


@pytest.mark.parametrize("name", log_curves())
def test_a_maker_in_the_file_names_its_own_curves(name):
    maker = name.split()[0]
    named = nearest_curves(Levels.of(log_picture(name)), (f"{maker.upper()} CORPORATION",))
    assert name in named
    assert all(each.startswith(maker) for each in named)


def test_the_nearest_curve_has_black_and_gray_where_the_picture_has():
    for name in ("Apple Log", "ARRI LogC4", "Sony S-Log2"):
        levels = Levels.of(log_picture(name))
        best = log_curves()[nearest_curves(levels)[0]]
        assert len(nearest_curves(levels)) == 4
        assert abs(float(best(0.0)) - float(log_curves()[name](0.0))) < 0.035


def test_log_footage_is_recognized_with_its_remedy():
    found = recognize(Levels.of(log_picture("Panasonic V-Log")), log_probability=0.9, makes=("Panasonic",))
    assert (found.kind, found.curves, found.color_space) == (Kind.LOG_FOOTAGE, ("Panasonic V-Log",), "V-Log V-Gamut")
    assert found.reason.startswith("log footage: black lies at code ")
    assert 'in ACES configs "V-Log V-Gamut"' in found.advice
    assert recognize(Levels.of(log_picture("Panasonic V-Log")), log_probability=0.4) is None


@pytest.mark.parametrize("seed", range(4))
def test_limited_range_is_recognized_and_the_full_range_is_not(seed):
    full = ordinary_picture(seed=seed)
    limited = quantized((16 + 219 * full.astype(float)) / 255)
    assert is_limited_range(Levels.of(limited))
    assert not is_limited_range(Levels.of(full))
    found = recognize(Levels.of(limited), log_probability=0.0)
    assert found.kind is Kind.LIMITED_RANGE
    assert found.advice.startswith("expand the range first")


def test_limited_range_of_10_bits():
    limited = quantized((64 + 876 * ordinary_picture().astype(float)) / 1023, bits=10)
    assert is_limited_range(Levels.of(limited))


@pytest.mark.parametrize("name", log_curves())
def test_log_footage_is_no_limited_range(name):
    assert not is_limited_range(Levels.of(log_picture(name)))


@pytest.mark.parametrize(("low", "high"), [(0, 235), (16, 255), (30, 220)])
def test_one_end_or_other_ends_are_no_limited_range(low, high):
    picture = quantized((low + (high - low) * ordinary_picture().astype(float)) / 255)
    assert not is_limited_range(Levels.of(picture))


def test_ends_without_a_pile_are_no_limited_range():
    """A picture whose samples thin out towards the codes 16 and 235 may have any range."""
    codes = np.random.default_rng(0).normal(125, 36, 600_000)
    inside = codes[(codes > 14) & (codes < 237)][:480_000].reshape(400, 400, 3)
    assert not is_limited_range(Levels.of(quantized(inside / 255)))


@pytest.mark.parametrize(
    ("tags", "found"),
    [
        (ColorTags(transfer="Sony S-Log3", source="ICC profile"), '"S-Log3 S-Gamut3.Cine"'),
        (ColorTags(transfer="PQ", source="CICP"), "is encoded as PQ: so says its metadata (CICP)"),
        (ColorTags(transfer="Cineon log", source="dpx"), "That curve is published"),
        (ColorTags(transfer="linear", source="CICP"), "is linear already: so says its metadata (CICP)"),
    ],
)
def test_a_tag_is_answered_with_the_color_space_to_choose(tags, found):
    assert found in tag_refusal(tags)
    assert "--ignore-metadata" in tag_refusal(tags)


def test_no_tag_is_no_refusal():
    assert tag_refusal(ColorTags()) == ""

import dataclasses
import json

import numpy as np
import pytest
from PIL import Image

from crfnet_core import Photo, read_photo
from crfnet_core.colorimetry import REC709
from crfnet_core.errors import PhotoError
from crfnet_core.photograph.metadata import FileMetadata, file_origin
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.metadata.jpeg import ANNEX_K_CHROMA, ANNEX_K_LUMA, scaled_table
from crfnet_core.photograph.recognition import (
    COLOR_SPACES,
    LOG_CURVES,
    Kind,
    Levels,
    Recognition,
    recognize,
    refuse_tagged,
)
from crfnet_core.photograph.recognition.levels import LUMA, has_few_levels, is_limited_range
from crfnet_core.photograph.recognition.log_footage import (
    BLACK_FACTOR,
    HIGH_WHITE_FACTOR,
    LIFTED_BLACK,
    LOW_WHITE_FACTOR,
    light_error,
    log_factor,
    nearest_curves,
)
from crfnet_core.types import typed_value
from tests.helpers.footage import limited_range_picture, log_picture, ordinary_picture, quantized
from tests.helpers.refusals import refused

#: Levels that nothing is recognized by.
PLAIN_LEVELS = Levels.from_pixels(ordinary_picture())


@pytest.mark.parametrize("name", LOG_CURVES)
def test_the_levels_of_log_footage_speak_for_log_and_not_for_limited_range(name):
    levels = Levels.from_pixels(log_picture(name))
    assert log_factor(levels) == pytest.approx(BLACK_FACTOR * LOW_WHITE_FACTOR)
    assert not is_limited_range(levels)


def test_a_lifted_black_with_a_clipped_white_says_less_and_an_ordinary_black_nothing():
    assert log_factor(PLAIN_LEVELS) == 1
    faded = quantized(0.1 + 0.9 * ordinary_picture().astype(float))
    assert log_factor(Levels.from_pixels(faded)) == pytest.approx(BLACK_FACTOR * HIGH_WHITE_FACTOR)


@pytest.mark.parametrize(("darkest", "brightest"), [(0.18, 0.18), (0.18, 0.4), (0.31, 0.9), (0.5, 0.95)])
def test_walls_gray_cards_and_skies_are_no_log_footage(darkest, brightest):
    """Their black is lifted, but their range is short, or their black higher than any log curve puts it."""
    picture = quantized(darkest + (brightest - darkest) * ordinary_picture().astype(float))
    assert Levels.from_pixels(picture).black > LIFTED_BLACK
    assert log_factor(Levels.from_pixels(picture)) == 1


@pytest.mark.parametrize("name", LOG_CURVES)
def test_a_maker_in_the_file_names_its_own_curves(name):
    maker = name.split()[0]
    named = nearest_curves(Levels.from_pixels(log_picture(name)), (f"{maker.upper()} CORPORATION",))
    assert name in [each.name for each in named]
    assert all(each.name.startswith(maker) for each in named)
    assert sum(each.probability for each in named) == pytest.approx(1)


def test_the_nearest_curve_has_black_and_gray_where_the_picture_has():
    for name in ("Apple Log", "ARRI LogC4", "Sony S-Log2"):
        levels = Levels.from_pixels(log_picture(name))
        best = LOG_CURVES[nearest_curves(levels)[0].name]
        assert len(nearest_curves(levels)) == 4
        assert abs(float(best(0.0)) - float(LOG_CURVES[name](0.0))) < 0.035


def test_log_footage_is_recognized_with_its_color_space():
    levels = Levels.from_pixels(log_picture("Panasonic V-Log"))
    recognition = recognize(levels, log_probability=0.9, makes=("Panasonic",))
    assert (recognition.kind, recognition.curves) == (Kind.LOG_FOOTAGE, ("Panasonic V-Log",))
    assert (recognition.probabilities, recognition.errors) == ((1.0,), (0.0,))
    assert recognition.color_space == "V-Log V-Gamut"
    assert recognition.color_space in recognition.advice
    assert recognize(levels, log_probability=0.4) is None


def test_without_a_maker_the_curves_have_probabilities_and_the_safest_its_color_space():
    recognition = recognize(Levels.from_pixels(log_picture("ARRI LogC3")), log_probability=0.9)
    safest = recognition.curves[int(np.argmin(recognition.errors))]
    assert list(recognition.probabilities) == sorted(recognition.probabilities, reverse=True)
    assert 0 < sum(recognition.probabilities) < 1
    assert recognition.color_space == COLOR_SPACES.get(safest, "")
    assert typed_value(json.loads(json.dumps(dataclasses.asdict(recognition))), Recognition) == recognition


def test_the_expected_error_is_the_mean_over_the_curves_that_it_may_be():
    levels, curves = Levels.from_pixels(log_picture("Canon Log 2")), LOG_CURVES
    names = [name for name in curves if name.startswith("Canon")]
    near = {each.name: each for each in nearest_curves(levels, ("Canon",))}
    assert set(near) == set(names)
    for name in names:
        errors = [near[true].probability * light_error(curves[name], curves[true], levels) for true in names]
        assert near[name].expected_error == pytest.approx(sum(errors))


def test_an_error_of_light_is_that_of_the_shape():
    levels = Levels.from_pixels(log_picture("ARRI LogC3"))
    curve = LOG_CURVES["ARRI LogC3"]
    assert light_error(curve, curve, levels) == 0
    assert light_error(lambda light: curve(2 * np.asarray(light)), curve, levels) < 0.01


@pytest.mark.parametrize(("seed", "bits"), [(0, 8), (1, 8), (2, 10)])
def test_limited_range_is_recognized_and_the_full_range_is_not(seed, bits):
    full = ordinary_picture(seed=seed)
    limited = quantized((16 + 219 * full.astype(float)) * 2 ** (bits - 8) / (2**bits - 1), bits)
    assert is_limited_range(Levels.from_pixels(limited))
    assert not is_limited_range(Levels.from_pixels(full))
    bars = [(len(full) // 4, 0), (0, 0), (0, 0)]  # of pure black
    assert [is_limited_range(Levels.from_pixels(np.pad(each, bars))) for each in (limited, full)] == [True, False]
    assert recognize(Levels.from_pixels(limited), log_probability=0.0).kind is Kind.LIMITED_RANGE


@pytest.mark.parametrize(("low", "high"), [(0, 235), (16, 255), (30, 220)])
def test_one_end_or_other_ends_are_no_limited_range(low, high):
    picture = quantized((low + (high - low) * ordinary_picture().astype(float)) / 255)
    assert not is_limited_range(Levels.from_pixels(picture))


@pytest.mark.parametrize(("low", "high", "is_limited"), [(15, 236, True), (25, 236, False), (15, 225, False)])
def test_without_a_pile_both_ends_have_to_lie_at_16_and_235(low, high, is_limited):
    codes = np.random.default_rng(0).normal(125, 45, 200_000)
    inside = codes[(codes > low) & (codes < high)][:160_000].reshape(400, 400, 1)
    assert is_limited_range(Levels.from_pixels(quantized(np.repeat(inside, 3, axis=2) / 255))) is is_limited


@pytest.mark.parametrize("quality", [70, 85, 95])
@pytest.mark.parametrize("subsampling", ["4:2:0", "4:4:4"])
def test_limited_range_is_recognized_after_compression(tmp_path, quality, subsampling):
    """Which rings at edges beyond black and white."""
    path = tmp_path / "a.jpg"
    Image.fromarray(limited_range_picture()).save(path, quality=quality, subsampling=subsampling)
    assert is_limited_range(Levels.from_pixels(read_photo(path).pixels))


def tables(quality):
    return {"luma_table": scaled_table(ANNEX_K_LUMA, quality), "chroma_table": scaled_table(ANNEX_K_CHROMA, quality)}


def origin_of(**fields):
    """Return what the metadata of a JPEG picture of 1600 x 1200 pixels, quality 75, without a camera's name says."""
    sent = {"width": 1600, "height": 1200, "file_format": "JPEG", "has_jfif": True}
    return file_origin(FileMetadata(**sent | tables(75) | fields))


@pytest.mark.parametrize(
    ("fields", "kind", "name"),
    [
        ({"renderer": "Blender"}, Kind.RENDERING, "Blender"),
        ({"make": "FLIR Systems AB", "model": "FLIR T640"}, Kind.THERMAL, "FLIR T640"),
        ({"make": "DJI", "model": "M3T", "width": 640, "height": 512}, Kind.THERMAL, "DJI M3T"),
        ({"make": "NIKON", "model": "D750", "software": "enfuse 4.2"}, Kind.MERGED, "enfuse 4.2"),
        ({"make": "DJI", "model": "FC3411", "width": 3750, "height": 3000}, None, ""),
        ({"make": "DJI", "model": "M3T", "width": 4000, "height": 3000}, None, ""),
    ],
)
def test_pictures_that_no_camera_of_light_made_are_recognized_by_their_metadata(fields, kind, name):
    recognition = recognize(PLAIN_LEVELS, log_probability=0.0, origins=[origin_of(**fields)])
    assert (recognition and recognition.kind) is kind
    assert name in (recognition.reason if recognition else "")


@pytest.mark.parametrize(
    ("fields", "is_sent"),
    [
        *(({}, True), ({"width": 1280, "height": 960}, True), ({"width": 4000, "height": 3000}, False)),
        ({"make": "Canon", "model": "Canon EOS 6D", "exif_size": (3200, 2400)}, False),
        (tables(90), False),
        ({"luma_table": (), "chroma_table": (), "file_format": "PNG"}, False),
    ],
)
def test_a_messengers_copy_is_recognized_by_its_metadata(fields, is_sent):
    recognition = recognize(PLAIN_LEVELS, log_probability=0.0, origins=[origin_of(**fields)])
    assert (recognition is not None and recognition.kind is Kind.SENT_COPY) is is_sent


@pytest.mark.parametrize(
    ("transfer", "code", "space"),
    [
        ("Sony S-Log3", "tagged_color_space", "S-Log3 S-Gamut3.Cine"),
        ("PQ", "tagged_color_space", "Rec.2100-PQ - Display"),
        ("Cineon log", "tagged_encoding", ""),
        ("linear", "tagged_linear", None),
    ],
)
def test_a_tag_is_refused_with_the_color_space_to_choose(transfer, code, space):
    with refused(PhotoError, code, space=space):
        refuse_tagged(tagged(ColorTags(transfer=transfer, transfer_source="CICP")))


def test_photographs_without_such_a_tag_are_not_refused():
    refuse_tagged(tagged(ColorTags(REC709, source="EXIF")))
    refuse_tagged(tagged(ColorTags()).with_metadata(None))


def tagged(color):
    return Photo.from_array(np.zeros((4, 4), np.uint8), metadata=FileMetadata(color=color))


@pytest.mark.parametrize("codes", [(0, 0, 0), (255, 255, 255), (200, 30, 60), (128, 129, 127)])
def test_a_flat_frame_is_recognized_and_advised_other_than_noise(codes):
    noise = np.random.default_rng(0).integers(0, 2, (64, 64, 1))
    levels = Levels.from_pixels(quantized((np.array(codes) + noise) / 256))
    flat, noise = (recognize(each, log_probability=0.9, is_noise=True) for each in (levels, PLAIN_LEVELS))
    assert (flat.kind, noise.kind, flat.advice == noise.advice) == (Kind.FLAT, Kind.FLAT, False)


@pytest.mark.parametrize(("white", "kind"), [(4095, Kind.FLAT), (16383, Kind.FLAT), (32768, Kind.FLAT), (39000, None)])
def test_a_white_far_below_the_largest_code_is_recognized(white, kind):
    recognition = recognize(Levels.from_pixels(quantized(ordinary_picture() * (white / 65535), 16)), log_probability=0)
    assert (recognition and recognition.kind) is kind
    if kind:
        assert f"between codes 0 and {round(255 * white / 65535)} of 255" in recognition.reason


@pytest.mark.parametrize("count", [2, 3, 4, 12, 40])
def test_a_picture_of_few_levels_is_recognized_and_no_log_footage(count):
    """Of two levels as a checkerboard; black is lifted as in log footage."""
    picture = 0.15 + 0.7 * np.rint(ordinary_picture() * (count - 1)) / (count - 1)
    assert recognize(Levels.from_pixels(quantized(picture)), log_probability=0.9).kind is Kind.FEW_LEVELS


def test_a_plain_background_and_a_small_range_are_no_few_levels():
    smooth = quantized(np.random.default_rng(0).normal(0.5, 0.2, (400, 400, 3)))
    backed = np.concatenate([smooth, np.full((900, 400, 3), 0.9)])
    for picture in (smooth, backed, 1.5 * smooth, 0.3 + 0.1 * ordinary_picture()):
        assert not has_few_levels(Levels.from_pixels(quantized(picture)))


def test_pictures_of_saturated_colors_are_not_limited_range():
    """Their luma ends where black and white of video lie, but channels go on to 0 or to 255."""
    codes = np.random.default_rng(0).normal(150, 60, (400, 400, 1)).clip(16, 235) / 255
    warm = np.concatenate([codes * 255 / 235, codes, codes * 0.777], axis=2)
    assert is_limited_range(Levels.from_pixels(quantized(np.repeat(warm @ LUMA.reshape(3, 1), 3, axis=2))))
    assert not is_limited_range(Levels.from_pixels(quantized(warm)))
    dark_yellow = np.where(codes < 0.25, codes * (1, 1, 0), codes)
    assert not is_limited_range(Levels.from_pixels(quantized(dark_yellow)))


def test_more_samples_beyond_16_and_235_than_at_them_are_not_limited_range():
    codes = np.random.default_rng(0).uniform(28, 175, 160_000)
    codes[:180] = np.repeat([5, 16, 235, 250], (60, 30, 30, 60))
    assert not is_limited_range(Levels.from_pixels(quantized(np.repeat(codes.reshape(400, 400, 1), 3, axis=2) / 255)))


def flat_picture(*shares, size=1000):
    """Return a picture of gray values, each with a share of the pixels."""
    values = np.concatenate([np.full(round(share * size * size), value) for value, share in shares])
    return np.repeat(values.reshape(size, size, 1), 3, axis=2).astype(np.float32)


def test_the_picture_is_not_changed_and_a_large_one_is_thinned():
    pixels = flat_picture((0.25, 0.5), (0.75, 0.5), size=2000)
    before = pixels.copy()
    assert Levels.from_pixels(pixels).histogram.sum() <= 3_000_000
    np.testing.assert_array_equal(pixels, before)


def test_several_pictures_count_the_same_whatever_their_size():
    pictures = flat_picture((0.25, 1.0), size=100), flat_picture((0.75, 1.0), size=500)
    joint = Levels.joint([Levels.from_pixels(picture) for picture in pictures])
    assert joint.histogram[:512].sum() / joint.histogram.sum() == pytest.approx(0.5)
    assert (joint.black, joint.white) == pytest.approx((0.25, 0.75), abs=1 / 1023)


def test_all_8_and_10_bit_codes_have_bins_of_their_own():
    for largest in (255, 1023):
        pixels = np.repeat((np.arange(largest + 1) / largest).astype(np.float32)[None, :, None], 3, axis=2)
        assert (Levels.from_pixels(pixels).histogram > 0).sum() == largest + 1

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import crfnet
import crfnet_core
from crfnet_core import AnalysisOptions, EmorBasis, Photo, ResponseCurve, ResponseNetwork, estimate_response, read_photo
from crfnet_core.errors import PhotoError
from crfnet_core.estimate.analysis import cut_photograph
from crfnet_core.network.inference import Predictions
from crfnet_core.network.pooling import agreeing, robust_mean
from crfnet_core.photograph.metadata import FileMetadata, file_origin
from crfnet_core.posterior import Evidence, Family, Posterior, Verdict
from crfnet_core.posterior.factors import family_factors
from crfnet_core.response.metrics import estimation_error
from tests.helpers.posteriors import even_prior, evidence_for, small_bank
from tests.helpers.refusals import refused

#: A file as the camera wrote it, and one that an editor saved.
CAMERA = FileMetadata(width=6000, height=4000, make="NIKON CORPORATION", model="NIKON D90", file_format="JPEG")
EDITED = replace(CAMERA, software="Adobe Photoshop 23.1 (Macintosh)")


class FakeNetwork(ResponseNetwork):
    """States given evidence, whatever the windows."""

    def __init__(self, windows, pooled=None):
        self.windows, self.pooled = tuple(windows), pooled
        self.config = SimpleNamespace(label="fake 000000000000")

    def predict(self, windows, *, progress=None):
        assert windows.shape == (len(self.windows), 227, 227, 3)
        return Predictions(self.windows, self.pooled or robust_mean(self.windows))


def photo(*, seed=0, shape=(300, 400), codes=(0, 256), is_gray=False, name="plate01.jpg", metadata=None):
    """A photograph of 4 x 4 darker and brighter fields, each with all codes: noise alone would be recognized."""
    rng = np.random.default_rng(seed)
    fields = np.kron(rng.uniform(0.4, 2.5, (4, 4, 1)), np.ones((shape[0] // 4, shape[1] // 4, 1)))
    pixels = np.floor(codes[0] + (codes[1] - codes[0]) * rng.random((*shape, 3)) ** fields).astype(np.float32)
    pixels /= np.float32(255)
    return Photo(pixels=pixels, bit_depth=8, is_gray=is_gray, path=Path("shots") / name, metadata=metadata)


def rows_around(center, offsets):
    rows = np.tile(np.asarray(center, dtype=np.float64), (len(offsets), 1))
    rows[:, 0] += offsets
    return rows


def asked(made, network, **options):
    """The estimate with the small bank and an even prior, of one window for each that the network knows."""
    prior = options.pop("prior", None) or even_prior()
    chosen = AnalysisOptions(**{"windows": len(network.windows), **options})
    return estimate_response(made, network=network, bank=small_bank(), prior=prior, options=chosen)


CENTER = np.array([1.0, -0.5, 0.0, 0.0, 0.0])


def test_outliers_are_those_beyond_twice_the_median_distance():
    windows = [evidence_for(row) for row in rows_around(CENTER, [-0.2, -0.1, 0.0, 0.1, 0.5, 3.0])]
    assert agreeing(windows).tolist() == [True, True, True, True, False, False]


def test_a_network_without_pooling_is_pooled_by_the_rule(bank):
    windows = [evidence_for(row) for row in rows_around(bank.weights[3], [-0.1, 0.0, 0.1])]
    estimate = asked(photo(), FakeNetwork(windows))
    expected = Posterior.from_evidences(bank, even_prior(), [evidence_for(bank.weights[3])])
    np.testing.assert_allclose(estimate.curve.brightness, expected.curve.brightness, atol=1e-9)
    assert estimate.uncertainty == pytest.approx(expected.expected_error)


def test_a_network_that_pools_has_the_last_word(bank):
    windows = [evidence_for(row) for row in bank.weights[[5, 5, 1, 5, 5]]]
    estimate = asked(photo(), FakeNetwork(windows, pooled=evidence_for(bank.weights[2], precision=300)))
    assert np.linalg.norm(estimate.curve.brightness - bank.brightness[2]) < 0.1
    assert [window.kept for window in estimate.windows] == [True, True, False, True, True]


def answer(weights):
    """Evidence about a whole response, which is the answer of a window."""
    return Evidence(np.asarray(weights, float), np.eye(11), np.full(3, -4.0))


def test_windows_with_whole_responses_are_answered_by_the_mean_of_those_that_agree(bank):
    """The bank and the prior have no part in the answer."""
    rows = bank.weights[4] + 0.3 * np.random.default_rng(2).standard_normal((6, 11))
    rows[2, 0] += 9
    estimate = asked(photo(), FakeNetwork([answer(row) for row in rows]))
    mean = np.delete(rows, 2, axis=0).mean(axis=0)
    expected = ResponseCurve.from_samples(EmorBasis.load().reconstruct(mean))
    np.testing.assert_allclose(estimate.curve.brightness, expected.brightness, atol=1e-12)
    np.testing.assert_array_equal([window.weights for window in estimate.windows], rows)
    assert [window.kept for window in estimate.windows] == [True, True, False, True, True, True]
    assert [warning.code for warning in estimate.warnings] == ["answer_of_windows"]


def test_a_mean_of_windows_that_is_no_response_is_made_one():
    wild = np.zeros(11)
    wild[5:] = 3.0
    assert np.diff(EmorBasis.load().reconstruct(wild)).min() < 0
    brightness = asked(photo(), FakeNetwork([answer(wild)] * 2)).curve.brightness
    assert (brightness[0], brightness[-1]) == (0, 1)
    assert np.diff(brightness).min() > 0


def test_an_answer_far_from_the_bank_is_expected_to_be_wrong(bank):
    near, far = bank.weights[4], bank.weights[4] + np.eye(11)[0] * 30
    first, second = (asked(photo(), FakeNetwork([answer(row)] * 2)) for row in (near, far))
    assert second.uncertainty > 10 > 3 * first.uncertainty


def test_the_estimate_says_what_the_posterior_says(bank):
    evidence = evidence_for(bank.weights[4])
    estimate = asked(photo(), FakeNetwork([evidence] * 2, pooled=evidence))
    expected = Posterior.from_evidences(bank, even_prior(), [evidence])
    assert estimate.uncertainty == expected.expected_error
    assert estimate.shape_uncertainty == expected.expected_shape_error
    assert estimate.families == expected.families
    assert estimate.verdict is Verdict.from_posterior(expected)
    np.testing.assert_array_equal(estimate.band, expected.band())
    np.testing.assert_array_equal(estimate.weights, EmorBasis.load().project(expected.curve.brightness))
    assert (estimate.prior, estimate.model) == ("even", "fake 000000000000")


def test_each_window_has_the_answer_of_its_own_evidence(bank):
    windows = [evidence_for(bank.weights[number], precision=300) for number in (1, 4)]
    first, second = asked(photo(), FakeNetwork(windows, pooled=windows[0])).windows
    np.testing.assert_allclose(first.weights, bank.weights[1], atol=0.1)
    np.testing.assert_allclose(second.weights, bank.weights[4], atol=0.1)
    assert second.expected_error < 0.2


def test_the_coverage_asked_for_reaches_the_choice_of_windows():
    dull = np.full((300, 900, 3), 0.5, np.float32)
    dull[:, 600:] = photo(shape=(300, 300)).pixels
    dull = Photo(pixels=dull, bit_depth=8, is_gray=False, path=Path("dull.jpg"))
    network = FakeNetwork([evidence_for(CENTER)] * 6)
    full, any_window = (asked(dull, network, coverage=coverage).windows for coverage in (220, 0))
    assert all(found.window.covers_range for found in full)
    assert not all(found.window.covers_range for found in any_window)


def test_photographs_of_one_camera_are_pooled(bank):
    network = FakeNetwork([evidence_for(bank.weights[3], precision=0.7)] * 2)
    photos = [photo(seed=1, name="a.jpg"), photo(seed=2, name="b.jpg", shape=(500, 300))]
    alone, together = asked(photos[0], network), asked(photos, network)
    assert [window.photo for window in together.windows] == [0, 0, 1, 1]
    assert together.photos == ("a.jpg", "b.jpg")
    assert together.uncertainty < alone.uncertainty


def test_the_same_photograph_twice_says_no_more_than_once(bank):
    network = FakeNetwork([evidence_for(bank.weights[3], precision=0.7)] * 2)
    dark = photo()
    dark = Photo(dark.pixels * np.float32(0.5), dark.bit_depth, dark.is_gray, dark.path, dark.metadata)
    once, twice = asked(photo(), network), asked([photo(), dark], network)
    assert twice.uncertainty == pytest.approx(once.uncertainty)
    assert twice.families == pytest.approx(once.families)


def test_of_several_photographs_the_geometric_mean_of_the_factors_counts():
    files = (CAMERA, replace(CAMERA, make="SONY", model="DSC-RX100"))
    each = [family_factors(file_origin(metadata)) for metadata in files]
    weighed = {kind: share * (each[0][kind] * each[1][kind]) ** 0.5 for kind, share in even_prior().shares.items()}
    expected = {family: weighed.get(family, 0) / sum(weighed.values()) for family in Family}
    nothing = FakeNetwork([Evidence(np.zeros(5), np.zeros((5, 5)), np.zeros(3))] * 2)
    made = [photo(seed=seed, metadata=metadata) for seed, metadata in enumerate(files)]
    assert asked(made, nothing).families == pytest.approx(expected)
    assert each[0] != each[1]


def test_metadata_can_be_ignored():
    ignored = asked(photo(metadata=EDITED), FakeNetwork([evidence_for(CENTER)]), use_metadata=False)
    bare = asked(photo(), FakeNetwork([evidence_for(CENTER)]))
    assert (ignored.origins, ignored.warnings) == ((), ())
    assert ignored.families == bare.families


def warnings_of(made):
    return [warning.code for warning in asked(made, FakeNetwork([evidence_for(CENTER)] * 2)).warnings]


@pytest.mark.parametrize(
    ("fields", "codes"),
    [
        *(({}, []), ({"metadata": CAMERA}, []), ({"metadata": EDITED}, ["edited"])),
        *(({"codes": (60, 220)}, ["narrow_range"]), ({"is_gray": True}, ["gray"])),
    ],
)
def test_a_photograph_is_warned_of_once(fields, codes):
    assert warnings_of([photo(**fields), photo(seed=1, **fields)]) == codes


@pytest.mark.parametrize("end", [0, 1])
def test_a_clipped_photograph_is_warned_of(end):
    pixels = photo().pixels.copy()
    pixels[:200] = end
    assert warnings_of(Photo.from_array(pixels, color_order="RGB", metadata=CAMERA)) == ["clipped"]


def test_photographs_of_different_cameras_are_warned_of():
    other = replace(CAMERA, model="NIKON D800")
    (warning,) = asked([photo(metadata=CAMERA), photo(metadata=other)], FakeNetwork([evidence_for(CENTER)])).warnings
    assert (warning.code, warning.facts) == ("several_cameras", {"cameras": "NIKON D90, NIKON D800"})
    assert warnings_of([photo(metadata=CAMERA), photo(seed=1, metadata=CAMERA), photo(seed=2)]) == []


@pytest.mark.parametrize("shape", [(226, 500), (500, 226), (1, 1)])
def test_a_small_photograph_is_named(shape):
    small = Photo(np.zeros((*shape, 3), np.float32), 8, True, "plate01.jpg")
    with refused(PhotoError, "smaller_than_window", path=Path("plate01.jpg")):
        estimate_response(small, network=FakeNetwork([]))


def test_evidence_for_the_true_response_brings_the_answer_near_it(plate, fixed_model, true_response):
    """The fixed model knows the bundled photograph's response, but not which response of the bank it is."""
    bundled = estimate_response(read_photo(plate), network=ResponseNetwork.load(fixed_model))
    assert estimation_error(true_response, bundled.curve) < 1
    project = EmorBasis.load().project
    assert np.linalg.norm((bundled.weights - project(true_response.brightness))[:5]) < 1
    lower, upper = bundled.band
    assert ((lower <= bundled.curve.brightness + 0.02) & (bundled.curve.brightness <= upper + 0.02)).mean() > 0.95


def test_a_photograph_that_is_cut_before_gives_the_same_estimate(plate, fixed_model):
    network, options = ResponseNetwork.load(fixed_model), AnalysisOptions(windows=2)
    cut = cut_photograph(read_photo(plate), options)
    whole = estimate_response(read_photo(plate), network=network, options=options)
    assert estimate_response(cut, network=network) == whole


def test_the_facade_takes_a_file_or_its_pixels_and_loads_the_network_once(plate, monkeypatch):
    expected = estimate_response(read_photo(plate), network=ResponseNetwork.load())
    assert crfnet.estimate(plate) == expected
    monkeypatch.setattr(ResponseNetwork, "load", None)
    assert crfnet.estimate(plate.read_bytes()).curve == expected.curve
    codes = np.round(255 * read_photo(plate)[:, :]).astype(np.uint8)
    bare = crfnet.estimate(codes, options=AnalysisOptions(use_metadata=False))
    alone = crfnet.estimate(plate, options=AnalysisOptions(use_metadata=False))
    assert replace(bare, photos=()) == replace(alone, photos=())


def test_the_public_names_are_few_and_the_same_in_both_packages():
    assert len(crfnet.__all__) <= 12
    for name in crfnet.__all__:
        assert getattr(crfnet, name) is getattr(crfnet_core, "estimate_photograph" if name == "estimate" else name)

import numpy as np
import pytest

from crfnet_core.statistics import CUES, LENGTH, unpack, window_statistics
from crfnet_core.statistics.channel_equations import EQUATION_LEVELS
from crfnet_core.statistics.sampling import Samples

#: Lines of a window that neighbors and edges are looked for on.
LINES = 114


def parts(window):
    return unpack(window_statistics(window))


def test_the_vector_holds_the_parts_of_every_cue():
    rng, position = np.random.default_rng(0), np.linspace(0, 9, 227)
    light = np.sin(position)[:, None] + np.cos(2 * position)[None, :] + 0.1 * rng.standard_normal((227, 227))
    light = (light - light.min()) / np.ptp(light)
    smooth = np.repeat(light[:, :, None], 3, axis=2).astype(np.float32)
    found = window_statistics(smooth)
    assert (found.shape, found.dtype) == ((LENGTH,), np.float32)
    samples = Samples.from_window(smooth)
    for cue in CUES:
        sums, *terms = cue.count(samples) if cue.terms else (cue.count(samples),)
        np.testing.assert_array_equal(unpack(found)[cue.name], sums.astype(np.float32), err_msg=cue.name)
        assert sums.shape == cue.shape
        assert [count.shape for count in terms] == ([cue.terms] if cue.terms else [])


def test_the_statistics_of_known_windows_have_not_changed(root):
    """`tests.data.make_golden_statistics` changes them; the network is then trained anew. New cues come last."""
    with np.load(root / "tests" / "data" / "golden_statistics.npz") as golden:
        for window, expected in zip(golden["windows"] / np.float32(255), golden["statistics"], strict=True):
            found = window_statistics(window)[: len(expected)]
            np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-3)


def test_a_flat_window_has_flat_neighbors_of_one_level_and_no_edge():
    found = parts(np.ones((227, 227, 3), np.float32))
    histogram, gradients = found.pop("histogram"), found.pop("gradients")
    np.testing.assert_allclose(histogram[:, -1], 227 * 227)
    assert not histogram[:, :-1].any()
    absolute_difference, log_difference, equal, signed_difference, count = gradients[0, 0]
    assert equal[-1] == count[-1] == 4 * 226 * LINES
    assert not absolute_difference.any()
    assert not log_difference.any()
    assert not signed_difference.any()
    assert not any(found[cue.name].any() for cue in CUES if cue.name in found)


def test_a_step_has_the_sums_that_one_can_count():
    """Code 0 on the left, 51 on the right: two samples of each row looked at have a neighbor 51 codes away."""
    window = np.zeros((227, 227, 3), np.float32)
    window[:, 100:] = 51 / 255
    gradients = parts(window)["gradients"]
    absolute_difference, log_difference, _, signed_difference, count = gradients[0].sum(axis=-1)[0]
    assert absolute_difference == pytest.approx(2 * LINES * 51)
    assert log_difference == pytest.approx(2 * LINES * np.log(52), rel=1e-5)
    assert signed_difference == pytest.approx(0, abs=1e-2)
    assert count == 4 * 226 * LINES
    assert gradients[0, 0, 3, 0] == pytest.approx(LINES * 51)


def test_a_row_of_known_triples():
    """One vertical edge of the codes 0, 128, 255: a triple across it, and two of half its height."""
    window = np.zeros((227, 227, 3), np.float32)
    window[:, 100], window[:, 101:] = 128 / 255, 1
    count, ratio = parts(window)["edges"][0]
    assert (count.sum(), count[0, -1]) == (pytest.approx(3 * 3 * LINES), pytest.approx(3 * LINES))
    assert ratio[0, -1] == pytest.approx(0, abs=1)
    halves = count[0, 7:9].sum()
    assert halves == pytest.approx(3 * LINES, rel=1e-5)
    assert ratio[0, 7:9].sum() == pytest.approx(-0.5 * halves, rel=1e-5)


def equations(power, near, far):
    """Return A (20, 20) and r (20,) of light that mixes two colors in many ratios, through the response E ** power."""
    rng = np.random.default_rng(0)
    ratios = np.clip(np.linspace(0, 1, 227)[:, None] + 0.12 * rng.standard_normal((227, 227)), 0, 1)[:, :, None]
    found = parts(((ratios * near + (1 - ratios) * far) ** power).astype(np.float32))["channel_equations"][0]
    return found[:-1], found[-1]


@pytest.mark.parametrize("power", [1.0, 1 / 1.5, 1 / 2.2])
def test_the_equations_between_channels_give_the_curvature_of_the_inverse(power):
    """g = B ** (1 / power) has g''/g' = (1 / power - 1) / B."""
    matrix, right = equations(power, np.array([0.9, 0.5, 0.15]), np.array([0.02, 0.1, 0.4]))
    np.testing.assert_allclose(matrix, matrix.T, rtol=1e-4, atol=1e-3)
    known = np.diagonal(matrix) > 200
    assert known.sum() >= 10
    curvature = np.linalg.solve(matrix + np.eye(EQUATION_LEVELS), right)
    level = (np.arange(EQUATION_LEVELS) + 0.5) / EQUATION_LEVELS
    np.testing.assert_allclose(curvature[known], ((1 / power - 1) / level)[known], rtol=0.1, atol=0.15)


def test_half_resolution_is_compared_whatever_color_the_samples_have_around_their_means():
    """As in a JPEG, of which a block of 2 x 2 samples has one color but for the rounding of its samples."""
    rng = np.random.default_rng(0)
    blocks = rng.integers(20, 230, (114, 114, 3))
    plain = blocks.repeat(2, axis=0).repeat(2, axis=1)[:227, :227]
    chequered = plain + 12 * (-1) ** np.add.outer(np.arange(227), np.arange(227))[:, :, None] * np.array([1, -1, 1])
    first, second = (parts((codes / 255).astype(np.float32)) for codes in (plain, chequered))
    halved, counts = "half_resolution_disagreement", "half_resolution_disagreement_counts"
    assert (first[counts][:, 0].sum(axis=1) > 1000).all()
    np.testing.assert_array_equal(first[halved], second[halved])
    np.testing.assert_array_equal(first[counts], second[counts])
    assert not np.array_equal(first["disagreement"], second["disagreement"])

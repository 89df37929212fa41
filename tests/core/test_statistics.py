import numpy as np
import pytest

from crfnet_core.statistics import COLOR_LEVELS, GRID, LEVELS, PARTS, STATISTICS, STRIDES, window_statistics

#: Lines of a window that neighbours and edges are looked for on.
LINES = 114


def parts(window):
    """Return histogram (3, LEVELS), neighbour sums (S, 3, 5, LEVELS), edge sums (S, 2, GRID, GRID), and the others."""
    ends = np.cumsum([np.prod(part) for part in PARTS])[:-1]
    return [part.reshape(shape) for part, shape in zip(np.split(window_statistics(window), ends), PARTS, strict=True)]


@pytest.fixture
def smooth():
    """Smooth light with texture, in [0, 1]."""
    rng, place = np.random.default_rng(0), np.linspace(0, 9, 227)
    light = np.sin(place)[:, None] + np.cos(2 * place)[None, :] + 0.1 * rng.standard_normal((227, 227))
    light = (light - light.min()) / np.ptp(light)
    return np.repeat(light[:, :, None], 3, axis=2).astype(np.float32)


def test_the_length_is_that_of_the_parts(smooth):
    found = window_statistics(smooth)
    assert found.shape == (STATISTICS,) == (11689,)
    assert found.dtype == np.float32


def test_every_sample_is_in_the_histogram(smooth):
    np.testing.assert_allclose(parts(smooth)[0].sum(axis=1), 227 * 227, rtol=1e-5)


def test_a_flat_window_has_flat_neighbours_of_one_level_and_no_edge():
    histogram, neighbours, *others = parts(np.ones((227, 227, 3), np.float32))
    np.testing.assert_allclose(histogram[:, -1], 227 * 227)
    assert not histogram[:, :-1].any()
    size, log_size, flat, lean, count = neighbours[0, 0]
    assert flat[-1] == count[-1] == 4 * 226 * LINES
    assert not size.any()
    assert not log_size.any()
    assert not lean.any()
    assert not any(part.any() for part in others)


def test_a_step_has_the_sums_that_one_can_count():
    """Code 0 on the left, 51 on the right: two samples of each row looked at have a neighbour 51 codes away."""
    window = np.zeros((227, 227, 3), np.float32)
    window[:, 100:] = 51 / 255
    size, log_size, _, lean, count = parts(window)[1][0].sum(axis=-1)[0]
    assert size == pytest.approx(2 * LINES * 51)
    assert log_size == pytest.approx(2 * LINES * np.log(52), rel=1e-5)
    assert lean == pytest.approx(0, abs=1e-2)
    assert count == 4 * 226 * LINES
    low_level = parts(window)[1][0][0, 3, 0]
    assert low_level == pytest.approx(LINES * 51)


def test_a_row_of_known_triples():
    """One vertical edge of the codes 0, 128, 255: a triple across it, and two of half its height."""
    window = np.zeros((227, 227, 3), np.float32)
    window[:, 100], window[:, 101:] = 128 / 255, 1
    count, place = parts(window)[2][0]
    assert count.sum() == pytest.approx(3 * 3 * LINES)
    assert count[0, -1] == pytest.approx(3 * LINES)
    assert place[0, -1] == pytest.approx(0, abs=1)
    halves = count[0, 7:9].sum()
    assert halves == pytest.approx(3 * LINES, rel=1e-5)
    assert place[0, 7:9].sum() == pytest.approx(-0.5 * halves, rel=1e-5)


def test_a_concave_response_lifts_the_middles_of_edges(smooth):
    def mean_place(window):
        count, place = parts(window)[2][STRIDES.index(16)]
        return place.sum() / count.sum()

    assert abs(mean_place(smooth)) < 0.02
    assert mean_place(np.sqrt(smooth)) > mean_place(smooth) + 0.02


def test_statistics_are_of_the_window_whatever_its_memory_layout(smooth):
    np.testing.assert_array_equal(window_statistics(smooth), window_statistics(np.asfortranarray(smooth)))
    before = smooth.copy()
    window_statistics(smooth)
    np.testing.assert_array_equal(smooth, before)


def equations(power, near, far):
    """Return A (20, 20) and r (20,) of light that mixes two colours in many shares, through the response E ** power."""
    rng = np.random.default_rng(0)
    shares = np.clip(np.linspace(0, 1, 227)[:, None] + 0.12 * rng.standard_normal((227, 227)), 0, 1)[:, :, None]
    found = parts(((shares * near + (1 - shares) * far) ** power).astype(np.float32))[3][0]
    return found[:-1], found[-1]


@pytest.mark.parametrize("power", [1.0, 1 / 1.5, 1 / 2.2])
def test_the_equations_between_channels_give_the_bend_of_the_inverse(power):
    """g = B ** (1 / power) has g''/g' = (1 / power - 1) / B."""
    matrix, right = equations(power, np.array([0.9, 0.5, 0.15]), np.array([0.02, 0.1, 0.4]))
    np.testing.assert_allclose(matrix, matrix.T, rtol=1e-4, atol=1e-3)
    known = np.diagonal(matrix) > 200
    assert known.sum() >= 10
    bend = np.linalg.solve(matrix + np.eye(COLOR_LEVELS), right)
    level = (np.arange(COLOR_LEVELS) + 0.5) / COLOR_LEVELS
    np.testing.assert_allclose(bend[known], ((1 / power - 1) / level)[known], rtol=0.1, atol=0.15)


def test_gray_says_nothing_between_channels():
    matrix, right = equations(0.5, np.ones(3), np.zeros(3))
    np.testing.assert_allclose(matrix, 0, atol=0.01)
    np.testing.assert_allclose(right, 0, atol=0.01)


def test_blocks_are_compared_whatever_colour_their_samples_have_around_their_means():
    """As in a JPEG, of which a block of 2 x 2 samples has one colour but for the rounding of its samples."""
    rng = np.random.default_rng(0)
    blocks = rng.integers(20, 230, (114, 114, 3))
    plain = blocks.repeat(2, axis=0).repeat(2, axis=1)[:227, :227]
    chequered = plain + 12 * (-1) ** np.add.outer(np.arange(227), np.arange(227))[:, :, None] * np.array([1, -1, 1])
    first, second = (parts((codes / 255).astype(np.float32)) for codes in (plain, chequered))
    assert (first[-1][:, 0].sum(axis=1) > 1000).all()
    for which in (-2, -1):
        np.testing.assert_array_equal(first[which], second[which])
    assert not np.array_equal(first[6], second[6])


def test_turning_a_window_by_half_a_turn_keeps_short_strides(smooth):
    first, second = (parts(window) for window in (smooth, smooth[::-1, ::-1]))
    np.testing.assert_allclose(first[1][:3], second[1][:3], rtol=1e-4, atol=1e-2)
    np.testing.assert_allclose(first[2][:3], second[2][:3], rtol=1e-4, atol=1e-2)
    assert (LEVELS, GRID) == (64, 16)

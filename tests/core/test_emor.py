import numpy as np
import pytest

from crfnet_core.errors import CurveError
from crfnet_core.response.curve import SAMPLES, UNIFORM
from crfnet_core.response.emor import COMPONENTS, EmorBasis


def test_the_packaged_basis_is_orthonormal_about_a_mean_from_0_to_1():
    mean, components = EmorBasis.load().mean, EmorBasis.load().components
    assert (mean.shape, components.shape) == ((SAMPLES,), (COMPONENTS, SAMPLES))
    np.testing.assert_allclose(components @ components.T, np.eye(COMPONENTS), atol=1e-12)
    assert (components.sum(axis=1) > 0).all()
    np.testing.assert_allclose(mean[[0, 512, -1]], [0, 0.75436, 1], atol=5e-5)
    assert (np.diff(mean) > 0).all()


def test_project_undoes_reconstruct():
    weights = np.random.default_rng(0).normal(size=(4, 3, COMPONENTS))
    basis = EmorBasis.load()
    assert basis.reconstruct(weights).shape == (4, 3, SAMPLES)
    np.testing.assert_allclose(basis.project(basis.reconstruct(weights)), weights, atol=1e-12)


@pytest.mark.parametrize("values", ["x", None, [[0], [1, 0]], 0.5, [], np.zeros((2, 5))])
@pytest.mark.parametrize(("function", "length"), [(EmorBasis.project, SAMPLES), (EmorBasis.reconstruct, COMPONENTS)])
def test_other_values_are_refused(values, function, length):
    for each in (values, np.full(length, np.nan)):
        with pytest.raises(CurveError):
            function(EmorBasis.load(), each)


@pytest.mark.parametrize("curve", [255 * UNIFORM, np.round(255 * UNIFORM).astype("u1"), 1 - UNIFORM, 0 * UNIFORM])
def test_curves_that_do_not_run_from_0_to_1_have_no_weights(curve):
    with pytest.raises(CurveError):
        EmorBasis.load().project([UNIFORM, curve])


def test_a_basis_of_curves_explains_them_in_order():
    rng = np.random.default_rng(2)
    exponents = np.exp(rng.normal(0, 0.4, 40))
    curves = UNIFORM ** exponents[:, None]
    basis = EmorBasis.from_curves(curves)
    assert (np.diff(np.var(basis.project(curves), axis=0)) <= 0).all()
    np.testing.assert_allclose(basis.reconstruct(basis.project(curves)), curves, atol=1e-4)


def test_a_basis_needs_enough_curves():
    with pytest.raises(ValueError, match="needs more than 11 curves"):
        EmorBasis.from_curves(np.zeros((5, SAMPLES)))

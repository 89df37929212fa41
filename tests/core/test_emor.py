import numpy as np
import pytest

from crfnet_core.response.curve import SAMPLES, UNIFORM
from crfnet_core.response.emor import COMPONENTS, EmorBasis


def test_the_packaged_basis_is_orthonormal():
    basis = EmorBasis.load()
    assert basis.mean.shape == (SAMPLES,)
    assert basis.components.shape == (COMPONENTS, SAMPLES)
    np.testing.assert_allclose(basis.components @ basis.components.T, np.eye(COMPONENTS), atol=1e-12)
    assert (basis.components.sum(axis=1) > 0).all()


def test_the_mean_response_runs_from_0_to_1():
    mean = EmorBasis.load().mean
    assert mean[0] == pytest.approx(0, abs=1e-9)
    assert mean[-1] == pytest.approx(1, abs=1e-9)
    assert (np.diff(mean) > 0).all()
    assert mean[512] == pytest.approx(0.75436, abs=5e-5)


def test_project_undoes_reconstruct():
    weights = np.random.default_rng(0).normal(size=(4, 3, COMPONENTS))
    basis = EmorBasis.load()
    assert basis.reconstruct(weights).shape == (4, 3, SAMPLES)
    np.testing.assert_allclose(basis.project(basis.reconstruct(weights)), weights, atol=1e-12)


def test_a_basis_of_curves_explains_them_in_order():
    rng = np.random.default_rng(2)
    exponents = np.exp(rng.normal(0, 0.4, 40))
    curves = UNIFORM ** exponents[:, None]
    basis = EmorBasis.from_curves(curves)
    spread = np.var(basis.project(curves), axis=0)
    assert (np.diff(spread) <= 0).all()
    np.testing.assert_allclose(basis.reconstruct(basis.project(curves)), curves, atol=1e-4)


def test_a_basis_needs_enough_curves():
    with pytest.raises(ValueError, match="needs more than 11 curves"):
        EmorBasis.from_curves(np.zeros((5, SAMPLES)))

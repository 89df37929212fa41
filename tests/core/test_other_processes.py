import copy
import multiprocessing
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from crfnet_core import AnalysisOptions, ResponseCurve, ResponseNetwork, estimate_response, read_photo
from crfnet_core.estimate.facade import estimate


@pytest.fixture(scope="module")
def photo(plate):
    return read_photo(plate)


def test_a_new_process_gives_the_same_estimate(photo):
    """By spawn, as on Windows and macOS: the photograph goes there, the estimate comes back."""
    options = AnalysisOptions(windows=3)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        found = pool.apply(estimate, (photo,), {"options": options})
    assert found == estimate(photo, options=options)
    assert not found.curve.brightness.flags.writeable


def test_threads_share_a_network(photo):
    network = ResponseNetwork.load()
    options = AnalysisOptions(windows=3)
    with ThreadPoolExecutor(3) as threads:
        found = list(threads.map(lambda _: estimate_response(photo, network=network, options=options), range(3)))
    assert found[0] == found[1] == found[2]


def test_a_curve_is_sent_without_its_tables():
    curve = ResponseCurve.gamma()
    plain = len(pickle.dumps(curve))
    curve.inverse(np.linspace(0, 1, 10**5))
    assert len(pickle.dumps(curve)) == plain < 9000
    for again in (pickle.loads(pickle.dumps(curve)), copy.deepcopy(curve)):
        assert again == curve
        assert not again.brightness.flags.writeable

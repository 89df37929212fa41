"""What crosses to other processes and threads: networks, photographs, curves and estimates."""

import copy
import json
import multiprocessing
import pickle
import shutil
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from crfnet_core.errors import ModelError
from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.network import DEFAULT_MODEL, ResponseNetwork
from crfnet_core.photograph.image_io import read_photo
from crfnet_core.response.curve import ResponseCurve


@pytest.fixture(scope="module")
def photo(plate):
    return read_photo(plate)


@pytest.mark.parametrize("model", [None, "fixed"])
def test_a_new_process_gives_the_same_estimate(photo, fixed_model, model):
    """By spawn, as on Windows and macOS: the photograph and the network go there, the estimate comes back."""
    network = ResponseNetwork.load(model and fixed_model)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        found = pool.apply(estimate_response, (photo,), {"network": network, "options": AnalysisOptions(windows=3)})
    assert found == estimate_response(photo, network=network, options=AnalysisOptions(windows=3))
    assert not found.curve.brightness.flags.writeable


def test_threads_share_a_network(photo):
    network = ResponseNetwork.load()
    options = AnalysisOptions(windows=3)
    with ThreadPoolExecutor(3) as threads:
        found = list(threads.map(lambda _: estimate_response(photo, network=network, options=options), range(3)))
    assert found[0] == found[1] == found[2]


def test_a_packaged_network_is_sent_by_its_name():
    """Where the packages lie may differ between machines."""
    sent = pickle.dumps(ResponseNetwork.load())
    assert DEFAULT_MODEL.name.encode() in sent
    assert str(DEFAULT_MODEL.parent).encode() not in sent


def test_a_network_is_loaded_again_from_a_relative_folder(fixed_model, tmp_path, monkeypatch):
    shutil.copytree(fixed_model, tmp_path / "model")
    monkeypatch.chdir(tmp_path)
    sent = pickle.dumps(ResponseNetwork.load("model", threads=2))
    monkeypatch.chdir(tmp_path.parent)
    network = pickle.loads(sent)
    assert (network.config.name, network._threads) == ("fixed", 2)


def test_another_model_in_its_folder_is_refused(fixed_model, tmp_path):
    folder = shutil.copytree(fixed_model, tmp_path / "model")
    sent = pickle.dumps(ResponseNetwork.load(folder))
    for path in DEFAULT_MODEL.iterdir():
        shutil.copyfile(path, folder / path.name)
    with pytest.raises(ModelError) as caught:
        pickle.loads(sent)
    assert caught.value.code == "other_model_here"


def test_an_absent_folder_is_named(fixed_model, tmp_path):
    folder = shutil.copytree(fixed_model, tmp_path / "model")
    sent = pickle.dumps(ResponseNetwork.load(folder))
    shutil.rmtree(folder)
    with pytest.raises(ModelError) as caught:
        pickle.loads(sent)
    assert caught.value.code == "unreadable_model"


def test_a_curve_is_sent_without_its_tables():
    curve = ResponseCurve.gamma()
    plain = len(pickle.dumps(curve))
    curve.inverse(np.linspace(0, 1, 10**5))
    assert len(pickle.dumps(curve)) == plain < 9000
    for again in (pickle.loads(pickle.dumps(curve)), copy.deepcopy(curve)):
        assert again == curve
        assert not again.brightness.flags.writeable


def test_an_estimate_is_sent_whole(photo, fixed_model):
    estimate = estimate_response(photo, network=ResponseNetwork.load(fixed_model), options=AnalysisOptions(windows=2))
    for again in (pickle.loads(pickle.dumps(estimate)), copy.deepcopy(estimate)):
        assert again == estimate
        assert json.dumps(again.to_dict()) == json.dumps(estimate.to_dict())

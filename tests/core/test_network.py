import json
import shutil
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from crfnet_core.errors import ModelError
from crfnet_core.network import DEFAULT_MODEL, MODELS, ModelConfig, ResponseNetwork, inference, model_folder
from crfnet_core.statistics import window_statistics

#: The evidence of all windows together in the golden predictions.
POOLED = ("pooled_location", "pooled_factor", "pooled_log_odds")


@pytest.fixture(scope="module")
def network():
    return ResponseNetwork.load()


@pytest.fixture(scope="module")
def golden(root):
    """Windows, their statistics, and what torch said of these."""
    arrays = {}
    for name in ("golden_statistics.npz", "golden_predictions.npz"):
        with np.load(root / "tests" / "data" / name) as file:
            arrays |= file
    return arrays


@pytest.fixture
def windows(golden):
    return golden["windows"] / np.float32(255)


@pytest.fixture
def copied(tmp_path):
    """A model folder that a test may spoil."""
    return shutil.copytree(DEFAULT_MODEL, tmp_path / "model")


def predictions(network, windows, *, progress=None):
    return network.predict(network.inputs(windows, progress=progress), progress=progress)


def locations(found):
    return np.stack([evidence.location for evidence in found.windows])


def assert_near(evidence, expected, tolerance):
    """Evidence equals (location, factor, log-odds); the factor relative to its largest entry."""
    location, factor, log_odds = expected
    np.testing.assert_allclose(evidence.location, location, atol=tolerance)
    np.testing.assert_allclose(evidence.factor, factor, atol=tolerance * max(1, np.abs(factor).max()))
    np.testing.assert_allclose(evidence.log_odds, log_odds, atol=tolerance)


def edit(folder, **entries):
    path = folder / "model.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | entries))


def test_onnxruntime_says_what_torch_said(network, golden, tolerance):
    """Factors are compared relative to the largest."""
    found = network.predict(golden["statistics"])
    for row, evidence in enumerate(found.windows):
        assert_near(evidence, [golden[name][row] for name in ("locations", "factors", "log_odds")], tolerance.parity)
    assert_near(found.pooled, [golden[name][0] for name in POOLED], tolerance.parity)
    assert np.abs(golden["locations"]).max() > 0.1


def test_threads_do_not_change_the_result(windows, fixed_model):
    """The packaged network reads statistics, the fixed one windows."""
    for model in (DEFAULT_MODEL, fixed_model):
        first, second = (predictions(ResponseNetwork.load(model, threads=threads), windows) for threads in (1, 3))
        np.testing.assert_array_equal(locations(first), locations(second))


def test_windows_are_independent_of_each_other(network, windows, tolerance):
    together = locations(predictions(network, windows))
    np.testing.assert_allclose(locations(predictions(network, windows[1:2])), together[1:2], atol=tolerance.parity)


def test_the_pooled_response_depends_on_all_windows_but_not_on_their_order(network, windows, tolerance):
    pooled = predictions(network, windows).pooled
    turned = predictions(network, windows[::-1]).pooled
    assert_near(turned, [pooled.location, pooled.factor, pooled.log_odds], tolerance.parity)
    assert np.linalg.norm(predictions(network, windows[:2]).pooled.location - pooled.location) > 1e-3


@pytest.mark.parametrize("level", [0.0, 0.5, 1.0])
def test_a_flat_window_has_a_finite_answer(network, level):
    found = predictions(network, np.full((2, 227, 227, 3), level, np.float32))
    for evidence in (found.pooled, *found.windows):
        assert all(np.isfinite(part).all() for part in (evidence.location, evidence.factor, evidence.log_odds))


def test_a_model_is_found_by_its_name_or_its_folder(copied):
    assert model_folder() == DEFAULT_MODEL
    assert model_folder("crfnet2017") == model_folder("crfnet2017-1.4") == MODELS / "crfnet2017-1.4"
    assert model_folder(copied) == copied
    assert model_folder("nonesuch").name == "nonesuch"


def test_the_paper_s_network_runs_by_name(windows):
    network = ResponseNetwork.load("crfnet2017")
    found = predictions(network, windows)
    assert network.config.name == "crfnet2017-1.4"
    assert locations(found).shape == (3, 5)
    assert found.pooled is None
    for evidence in found.windows:
        np.testing.assert_array_equal(evidence.factor, found.windows[0].factor)
        np.testing.assert_array_equal(evidence.log_odds, found.windows[0].log_odds)


def test_progress_counts_the_windows(network, windows):
    calls = []
    predictions(network, windows, progress=lambda done, total: calls.append((done, total)))
    assert calls == [(1, 3), (2, 3), (3, 3)]


def test_an_error_in_the_progress_stops_the_run(network, windows, monkeypatch):
    run = []
    monkeypatch.setattr(
        "crfnet_core.network.inference.window_statistics", lambda w: run.append(1) or window_statistics(w)
    )

    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        predictions(network, np.repeat(windows, 20, axis=0), progress=stop)
    assert len(run) < 60


def test_the_windows_are_not_changed(network, windows):
    before = windows.copy()
    predictions(network, windows)
    np.testing.assert_array_equal(windows, before)


def test_the_network_is_monotone_in_nothing_but_sees_the_response(network, windows):
    """Another curve on the same windows gives another estimate: the network looks at its input."""
    bent = np.rint(windows**0.6 * 255) / np.float32(255)
    moved = locations(predictions(network, bent)) - locations(predictions(network, windows))
    assert np.linalg.norm(moved) > 0.5


def test_config_is_complete():
    config = ModelConfig.read(DEFAULT_MODEL / "model.json")
    assert config.name == DEFAULT_MODEL.name
    assert (config.basis, config.components, config.window_size, config.opset) == ("emor", 5, 227, 18)
    assert len(config.training_commit.removesuffix("-dirty")) == 40
    assert len(config.output_names) == 6
    assert config.label == f"{config.name} {config.sha256[:12]}"


def test_the_package_stays_small():
    assert sum(path.stat().st_size for path in DEFAULT_MODEL.parent.rglob("*")) < 20e6


def test_the_config_may_be_named_by_a_text(fixed_model):
    assert ModelConfig.read(str(fixed_model / "model.json")) == ModelConfig.read(fixed_model / "model.json")


def test_an_altered_graph_is_refused(copied):
    with (copied / "model.onnx").open("ab") as file:
        file.write(b"x")
    with pytest.raises(ModelError, match=r"is not the file that model\.json describes"):
        ResponseNetwork.load(copied)


@pytest.mark.parametrize("name", ["model.onnx", "model.json"])
def test_an_absent_file_is_named(copied, name):
    (copied / name).unlink()
    with pytest.raises(ModelError, match=f"{name}: cannot be read"):
        ResponseNetwork.load(copied)


@pytest.mark.parametrize(
    ("text", "said"),
    [("{", "is not JSON"), ("[1]", "no JSON object"), ('{"name": "a"}', "lacks sha256"), ("\xff\xfe", "is not JSON")],
)
def test_a_spoiled_config_is_refused(copied, text, said):
    (copied / "model.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(ModelError, match=said) as caught:
        ResponseNetwork.load(copied)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ({"components": 25}, "25 weights of emor"),
        ({"components": 11}, "11 weights of emor"),
        ({"basis": "pca"}, "5 weights of pca"),
    ],
)
def test_a_model_of_another_kind_is_refused(copied, entries, said):
    edit(copied, **entries)
    with pytest.raises(ModelError, match=said):
        ResponseNetwork.load(copied)


def test_a_graph_without_an_output_is_refused(copied):
    """As of a model of an earlier version, whose network answers with weights."""
    edit(copied, output_names=["weights", "log_errors"])
    with pytest.raises(ModelError, match=r"model\.onnx has no log_errors, weights; export the model again"):
        ResponseNetwork.load(copied)


def test_a_graph_that_is_none_is_refused(copied):
    import hashlib

    (copied / "model.onnx").write_bytes(b"no graph")
    edit(copied, sha256=hashlib.sha256(b"no graph").hexdigest())
    with pytest.raises(ModelError, match=r"model\.onnx is no ONNX model"):
        ResponseNetwork.load(copied)


def test_as_many_windows_run_at_the_same_time_as_cores_may_be_used(windows, monkeypatch):
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {2, 5, 7}, raising=False)
    found = []
    monkeypatch.setattr(inference, "ThreadPoolExecutor", lambda count: found.append(count) or ThreadPoolExecutor(1))
    for threads in (0, 2):
        predictions(ResponseNetwork.load("crfnet2017", threads=threads), windows[:1])
    assert found == [3, 2]


def test_threads_are_not_negative():
    with pytest.raises(ModelError, match="threads"):
        ResponseNetwork.load(threads=-1)

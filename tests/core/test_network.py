import hashlib
import json
import os
import shutil
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from crfnet_core.errors import CRFNetError, ModelError
from crfnet_core.network import DEFAULT_MODEL, MODELS, ResponseNetwork, inference, model_folder
from crfnet_core.network.pooling import robust_mean
from crfnet_core.statistics import window_statistics
from tests.helpers.refusals import refusal_of, refused

#: The evidence of all windows together in the golden predictions.
POOLED = ("pooled_location", "pooled_factor", "pooled_log_odds")


@pytest.fixture(scope="module")
def network():
    return ResponseNetwork.load()


@pytest.fixture(scope="module")
def golden(root):
    """Windows and their statistics, and the answers of torch to these."""
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
    return shutil.copytree(DEFAULT_MODEL, tmp_path / "model")


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


def test_onnxruntime_answers_what_torch_answered(network, windows, golden, tolerance):
    found = network.predict(windows)
    for row, evidence in enumerate(found.windows):
        assert_near(evidence, [golden[name][row] for name in ("locations", "factors", "log_odds")], tolerance.parity)
    assert_near(found.pooled, [golden[name][0] for name in POOLED], tolerance.parity)
    assert np.abs(golden["locations"]).max() > 0.1


def test_threads_do_not_change_the_result(windows, fixed_model):
    """The packaged network reads statistics, the fixed one windows."""
    for model in (DEFAULT_MODEL, fixed_model):
        first, second = (ResponseNetwork.load(model, threads=threads).predict(windows) for threads in (1, 3))
        np.testing.assert_array_equal(locations(first), locations(second))


def test_the_pooled_response_depends_on_all_windows_but_not_on_their_order(network, windows, tolerance):
    pooled = network.predict(windows).pooled
    turned = network.predict(windows[::-1]).pooled
    assert_near(turned, [pooled.location, pooled.factor, pooled.log_odds], tolerance.parity)
    assert np.linalg.norm(network.predict(windows[:2]).pooled.location - pooled.location) > 1e-3


def test_a_model_is_found_by_its_name_or_its_folder(copied):
    assert model_folder() == DEFAULT_MODEL
    assert model_folder("crfnet2017") == model_folder("crfnet2017-2.0") == MODELS / "crfnet2017-2.0"
    assert model_folder(copied) == copied
    assert model_folder("nonesuch").name == "nonesuch"


def test_the_paper_s_network_runs_by_name_and_answers_as_in_torch(windows, root, tolerance):
    network = ResponseNetwork.load("crfnet2017")
    found = network.predict(windows)
    assert network.config.name == "crfnet2017-2.0"
    with np.load(root / "tests" / "data" / "golden_crfnet2017.npz") as golden:
        np.testing.assert_allclose(locations(found), golden["locations"], atol=tolerance.parity)
    assert locations(found).shape == (3, 11)
    np.testing.assert_array_equal(found.pooled.location, robust_mean(found.windows).location)
    assert found.pooled.is_answer


def test_progress_counts_the_windows(network, windows):
    calls = []
    network.predict(windows, progress=lambda done, total: calls.append((done, total)))
    assert calls == [(1, 3), (2, 3), (3, 3)]


def test_an_error_in_the_progress_stops_the_run(network, windows, monkeypatch):
    run = []
    monkeypatch.setattr(
        "crfnet_core.network.inference.window_statistics", lambda w: run.append(1) or window_statistics(w)
    )

    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        network.predict(np.repeat(windows, 20, axis=0), progress=stop)
    assert len(run) < 60


def refusal(folder):
    """Return the code of the error with which a model folder is refused, when it is loaded or when it is run."""
    with pytest.raises(ModelError) as caught:
        ResponseNetwork.load(folder).predict(np.full((2, 227, 227, 3), 0.5, np.float32))
    assert str(caught.value).startswith(str(folder))
    assert str(caught.value).isprintable()
    return caught.value.code


def write_graph(folder, content):
    (folder / "model.onnx").write_bytes(content)
    edit(folder, sha256=hashlib.sha256(content).hexdigest())
    return folder


def test_an_altered_graph_is_refused(copied):
    with (copied / "model.onnx").open("ab") as file:
        file.write(b"x")
    assert refusal(copied) == "altered_model"


@pytest.mark.parametrize("name", ["model.onnx", "model.json"])
def test_an_absent_file_or_a_pipe_is_named(copied, name):
    (copied / name).unlink()
    assert refusal(copied) == "unreadable_model"
    if hasattr(os, "mkfifo"):
        os.mkfifo(copied / name)
        assert refusal(copied) == "unreadable_model"


@pytest.mark.parametrize("content", [b"{", b"[1]", b"\xff\xfe", b"{}"])
def test_a_spoiled_config_is_refused(copied, content):
    (copied / "model.json").write_bytes(content)
    assert refusal(copied) == ("bad_model_config" if content == b"{}" else "bad_model_json")


#: Code -> entries of model.json that are refused with it.
OTHER_KINDS = {
    "bad_model_config": ({"opset": "18"}, {"opset": True}, {"output_names": ["locations", "locations", {}]}),
    "other_kind_of_model": (
        *({"components": 7}, {"basis": "pca"}, {"input_name": "pixels"}),
        *({"output_names": ["weights", "log_errors"]}, {"output_names": ["locations"] * 3}),
    ),
    "bad_output": ({"components": 11}, {"output_names": ["locations", "log_odds", "factors"]}),
    "failing_graph": ({"output_names": ["locations", "factors", "absent"]}, {"input_name": "windows"}),
}


@pytest.mark.parametrize(("code", "entries"), [(code, each) for code, kinds in OTHER_KINDS.items() for each in kinds])
def test_a_model_of_another_kind_is_refused(copied, code, entries):
    edit(copied, **entries)
    assert refusal(copied) == code


def test_a_file_that_holds_no_graph_is_refused(copied, capfd):
    assert refusal(write_graph(copied, b"no graph")) == "unloadable_graph"
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("length", [b"\x08", b"\x88\x00"])
def test_weights_in_another_file_are_refused(fixed_model, tmp_path, monkeypatch, length):
    """Also where onnxruntime would find it: in the current folder. Protocol Buffers merge what is appended."""
    folder = shutil.copytree(fixed_model, tmp_path / "model")
    (tmp_path / "secret.bin").write_bytes(bytes(4))
    monkeypatch.chdir(tmp_path)
    location = b"\x0a" + length + b"location" + field(2, b"secret.bin")
    outside = b"\x08\x01\x10\x01" + field(8, b"outside") + field(13, location) + b"\x70\x01"
    content = (folder / "model.onnx").read_bytes()
    assert ResponseNetwork.load(write_graph(folder, content + field(7, b"")))
    assert refusal(write_graph(folder, content + field(7, field(5, outside)))) == "external_weights"


def field(number, content):
    """Return a field of a message of Protocol Buffers."""
    head = bytes([number << 3 | 2, len(content) & 127])
    return (head if len(content) < 128 else head[:1] + length(len(content))) + content


def length(size):
    return bytes([size >> shift & 127 | 128 for shift in (0, 7, 14)] + [size >> 21])


@pytest.mark.parametrize(
    ("more", "code"),
    [
        (field(7, field(13, b"") * 20_000), "unloadable_graph"),  # each takes a hundred bytes of memory
        (field(7, field(1, field(3, bytes(5 * 2**20)))), "unloadable_graph"),
        (field(7, field(15, b"")), "external_weights"),  # 40 bytes can stand for gigabytes
        (field(7, field(1, field(5, field(1, b"sparse_value")))), "external_weights"),
        (b"\xba\x80\x80\x80\x10" + field(7, b"")[1:], "unloadable_graph"),  # a key of 33 bits
    ],
)
def test_a_graph_out_of_bounds_is_refused_before_onnxruntime_reads_it(fixed_model, tmp_path, monkeypatch, more, code):
    folder = shutil.copytree(fixed_model, tmp_path / "model")
    monkeypatch.setattr("crfnet_core.network.session.onnxruntime", None)
    assert refusal(write_graph(folder, (folder / "model.onnx").read_bytes() + more)) == code


def test_a_graph_whose_values_take_too_much_memory_is_refused(fixed_model, tmp_path):
    """Its output is of a shape that stands in its weights: 10 ** 9 numbers."""
    folder = shutil.copytree(fixed_model, tmp_path / "model")
    shape = field(5, b"\x08\x01\x10\x07" + field(8, b"shape") + field(9, (10**9).to_bytes(8, "little")))
    node = field(1, field(1, b"shape") + field(2, b"large") + field(4, b"ConstantOfShape"))
    output = field(12, field(1, b"large") + field(2, field(1, b"\x08\x01")))
    write_graph(folder, (folder / "model.onnx").read_bytes() + field(7, shape + node + output))
    edit(folder, output_names=["large", "factors", "log_odds"])
    assert refusal(folder) == "failing_graph"


def test_a_run_that_takes_too_long_ends(tmp_path, monkeypatch):
    monkeypatch.setattr("crfnet_core.network.session.RUN_SECONDS", 0)
    assert refusal(shutil.copytree(MODELS / "crfnet2017-2.0", tmp_path / "model")) == "failing_graph"


def test_as_many_windows_run_at_the_same_time_as_cores_may_be_used(windows, monkeypatch):
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {2, 5, 7}, raising=False)
    found = []
    monkeypatch.setattr(inference, "ThreadPoolExecutor", lambda count: found.append(count) or ThreadPoolExecutor(1))
    for threads in (0, 2):
        ResponseNetwork.load("crfnet2017", threads=threads).predict(windows[:1])
    assert found == [3, 2]


def test_folders_are_paths_and_threads_are_whole_numbers_and_not_negative():
    assert refusal("x" * 300) == "unreadable_model"
    with refused(CRFNetError, "argument_kind", name="folder"):
        ResponseNetwork.load(5)
    for threads in (-1, 1.5, "2", True):
        assert refusal_of(ModelError, ResponseNetwork.load, threads=threads).code == "negative_threads"

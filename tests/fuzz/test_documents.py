import hashlib
import json
import shutil

import numpy as np
import pytest

from crfnet.configs.looks import read_looks
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import Lut1D
from crfnet.pipeline.calibrations import response_to_compare
from crfnet_core import CRFNetError, ResponseEstimate, ResponseNetwork
from crfnet_core.library import camera_estimate
from crfnet_core.library.camera import read_camera
from crfnet_core.library.library import SHIPPED
from crfnet_core.posterior import Prior
from crfnet_core.posterior.prior import PRIORS
from crfnet_core.statistics.windows import WINDOW_SIZE
from tests.helpers.mutations import mutated, mutated_text, mutated_value


def damaged_json(document, generator):
    """A document with another value, or its text with other words or bytes."""
    text = json.dumps(document, indent=1)
    match generator.integers(4):
        case 0:
            return mutated(text.encode(), generator)
        case 1:
            return mutated_text(text, generator, ("[" * 5000, "NaN", "{", "}")).encode(errors="surrogatepass")
        case _:
            return json.dumps(mutated_value(document, generator)).encode()


def test_damaged_descriptions_of_models_are_refused(fuzz, refused, fixed_model, tmp_path):
    folder = shutil.copytree(fixed_model, tmp_path / "m")
    document = json.loads((folder / "model.json").read_text())

    def case(generator):
        (folder / "model.json").write_bytes(damaged_json(document, generator))
        refused(ResponseNetwork.load, folder)

    fuzz(case)


def test_damaged_graphs_are_run_or_refused(fuzz, refused, fixed_model, tmp_path):
    folder = shutil.copytree(fixed_model, tmp_path / "m")
    graph, document = (folder / "model.onnx").read_bytes(), json.loads((folder / "model.json").read_text())
    windows = np.full((1, WINDOW_SIZE, WINDOW_SIZE, 3), 0.5, np.float32)

    def case(generator):
        content = mutated(graph, generator)
        (folder / "model.onnx").write_bytes(content)
        (folder / "model.json").write_text(json.dumps(document | {"sha256": hashlib.sha256(content).hexdigest()}))
        refused(lambda path: ResponseNetwork.load(path).predict(windows), folder)

    fuzz(case)


@pytest.fixture(scope="module")
def document(root):
    return json.loads((root / "docs" / "sample" / "plate.json").read_text())


def test_damaged_documents_are_read_or_refused(fuzz, refused, document, tmp_path):
    prior = json.loads((PRIORS / "camera.json").read_text())
    write_lut(tmp_path / "plate.spi1d", Lut1D([0, 0.2, 1]))

    def case(generator):
        path = tmp_path / "prior.json"
        path.write_bytes(damaged_json(prior, generator))
        refused(Prior.load, path)
        path = tmp_path / "plate.json"
        path.write_bytes(damaged_json(document, generator))
        refused(response_to_compare, path)
        refused(lambda folder: read_looks(folder / "plate.json"), tmp_path)

    fuzz(case)


def test_damaged_estimates_are_read_or_refused(fuzz, document):
    def case(generator):
        damaged = mutated_value(document, generator)
        try:
            ResponseEstimate.from_dict(damaged)
        except CRFNetError as problem:
            line = str(problem)
        else:
            return
        assert line.isprintable(), line

    fuzz(case)


def test_damaged_cameras_are_read_or_refused(fuzz, refused, tmp_path):
    document = json.loads(min(SHIPPED.glob("*.json")).read_text())

    def case(generator):
        path = tmp_path / "camera.json"
        path.write_bytes(damaged_json(document, generator))
        if not refused(read_camera, path):
            camera_estimate(read_camera(path))

    fuzz(case)

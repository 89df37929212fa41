"""Paths, tolerances and small things that many tests use."""

import contextlib
import io
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from unittest import mock

import numpy as np
import pytest

from crfnet.cli import main
from tests.helpers.images import write_image

if TYPE_CHECKING:
    from crfnet_core import ResponseEstimate
    from crfnet_core.response.curve import ResponseCurve


@dataclass(frozen=True)
class Tolerance:
    """The one block of tolerances (absolute, on values in [0, 1] unless it says otherwise)."""

    exact: float = 1e-12  # the same arithmetic in float64
    lut: float = 1e-6  # OCIO, colour-science and numpy on one LUT, in float32
    plate: float = 1e-5  # float EXR: oiiotool, Blender and `crfnet linearize`
    half: float = 2**-11  # half EXR, relative to the value
    parity: float = 1e-3  # torch and onnxruntime, evidence: EMoR weights, log-odds; factors relative to the largest


@dataclass(frozen=True)
class CommandResult:
    """How a command ended."""

    code: int
    out: str
    err: str
    problem: str

    @property
    def printed(self) -> str:
        """The text that a command printed which succeeded without a word on stderr."""
        assert (self.code, self.err) == (0, "")
        return self.out

    @property
    def refusal(self) -> str:
        """The code of the error for which the command ended with exit status 2 and one line."""
        assert (self.code, self.err.count("\n"), self.err[:15]) == (2, 1, "crfnet: error: ")
        return self.problem


@pytest.fixture(scope="session", autouse=True)
def own_cameras(tmp_path_factory) -> Iterator[Path]:
    """The user's library of cameras: an empty one, whatever is kept on this machine."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("data")
        patch.setenv("CRFNET_DATA_DIR", str(folder))
        yield folder / "cameras"


@pytest.fixture(scope="session")
def tolerance() -> Tolerance:
    return Tolerance()


@pytest.fixture(scope="session")
def root() -> Path:
    """The project's root folder."""
    return Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def plate(root) -> Path:
    """The bundled photograph, whose true response is known."""
    return root / "tests" / "data" / "plate.jpg"


@pytest.fixture(scope="session")
def true_response(root) -> "ResponseCurve":
    """The response through which the bundled photograph was made."""
    # Not earlier: in Blender, its own OpenImageIO has to come first.
    from crfnet_core.response.curve import ResponseCurve

    table = np.loadtxt(root / "tests" / "data" / "plate_response.csv", delimiter=",", skiprows=1)
    return ResponseCurve.from_samples(table[:, 1])


@pytest.fixture(scope="session")
def fixed_model(root) -> Path:
    """A model folder whose network always states evidence for the bundled photograph's true response."""
    return root / "tests" / "data" / "fixed_model"


@pytest.fixture(scope="session")
def crfnet() -> Callable[..., CommandResult]:
    """Run the `crfnet` command in this process: crfnet("info", path) -> its exit code and what it printed.

    Its problem is the code of an error, the name of another exception, or "usage" where the arguments do not parse.
    """

    def run(*arguments: object) -> CommandResult:
        out, err = io.StringIO(), io.StringIO()
        with (
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
            mock.patch.object(main, "_fail", wraps=main._fail) as fail,
        ):
            try:
                code = main.main([str(argument) for argument in arguments])
            except SystemExit as leaving:
                code = int(leaving.code or 0)
        problems = [getattr(call.args[0], "code", type(call.args[0]).__name__) for call in fail.call_args_list]
        return CommandResult(code, out.getvalue(), err.getvalue(), *(problems or ["usage"]))

    return run


@pytest.fixture(scope="session")
def oiiotool() -> Callable[..., None]:
    """Run oiiotool, which comes with OpenImageIO's wheel; it must succeed."""

    def run(*arguments: object) -> None:
        command = [str(Path(sys.executable).with_name("oiiotool")), *map(str, arguments)]
        subprocess.run(command, check=True, capture_output=True, text=True)

    return run


@pytest.fixture(scope="session")
def bank():
    """A small bank of powers of irradiance, whose posteriors can be worked out by hand."""
    from tests.helpers.posteriors import small_bank

    return small_bank()


@pytest.fixture(scope="session")
def codes() -> np.ndarray:
    """Code values, uint8, shape (256, 256, 3): every 8-bit code in each channel, in a different order in each."""
    ramp = np.arange(256, dtype=np.uint8)
    red = np.repeat(ramp[None], 256, axis=0)
    return np.stack([red, red.T, red[:, ::-1]], axis=2)


@pytest.fixture
def plate_file(tmp_path, codes) -> Path:
    """A photograph of these code values."""
    return write_image(tmp_path / "plate.png", codes)


@pytest.fixture
def estimate(fixed_model) -> "Callable[..., ResponseEstimate]":
    """Estimate the response of files with the fixed model: estimate(path, ..., use_metadata=True)."""
    from crfnet_core import AnalysisOptions, ResponseNetwork, estimate_response, read_photo

    network = ResponseNetwork.load(fixed_model)

    def estimated(*paths, prior=None, **options):
        chosen = AnalysisOptions(**options)
        return estimate_response(map(read_photo, paths), network=network, prior=prior, options=chosen)

    return estimated

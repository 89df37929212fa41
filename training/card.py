"""Put measured figures into a model folder: ``python -m training.card --model DIR --p0 FILE --real FILE``.

Both files come from `training.evaluate`; model.json gets their summaries, README.md the model card.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from crfnet_core.files import write_text_whole
from crfnet_core.network import ModelConfig
from training.scenes import VALIDATION_SCENES

INTRODUCTION = """# {name}

Estimates the response of a camera from windows of one photograph. `model.onnx` and `model.json` belong together:
the second holds the hash of the first.

| | |
| --- | --- |
| input | `{input_name}`, float32 (N, {window_size}, {window_size}, 3): {normalisation} |
| output | `{output_names[0]}`: (N, {components}) EMoR weights; `{output_names[1]}`: (N,) log of the expected E_est |
| file | {size:.1f} MB, ONNX opset {opset}, sha256 `{sha256}` |
| trained from | commit `{training_commit}` |

**Inside.** The graph counts, for every window, histograms, gradients at each brightness level at strides 1 to 16, and
where the middle of an edge lies between its sides; a small fully connected network turns these statistics into the
weights. See `training/model.py`.

**Trained on** synthetic windows of 94 linear photographs (CC0 and BSD-3-Clause), with random exposure, white balance,
noise, sharpening and JPEG compression. Half of the responses are those of DoRF (201 measured curves; half of these as
they are, half mixed and warped), half are in-camera base curves of 24 modern cameras with random headroom, mixed and
warped: photographs of today's cameras follow the second family, the published figures are on the first. All 201 DoRF
curves are in training, so P0 below says how it does on new photographs of known responses, and the real photographs
how it does on new cameras.

**Uncertainty.** E_est = {base} + {of_predicted} x (mean error that the network expects of the kept windows) +
{of_spread} x (RMS distance of their estimates from the mean); fitted, like the 90 % band, on {calibration_scenes}
validation scenes photographed by random cameras.

"""


def card(folder: Path, config: ModelConfig, real: dict[str, Any]) -> str:
    """Return the model card."""
    entries = asdict(config) | asdict(config.calibration)
    entries["size"] = (folder / "model.onnx").stat().st_size / 1e6
    entries["calibration_scenes"] = VALIDATION_SCENES
    p0, p4 = config.accuracy["P0"], config.accuracy["P4"]
    rows = [f"| {name} | {figure} | {p4[name]} |" for name, figure in p0.items()]
    cameras = [
        f"| {camera} | {row['photographs']} | {row['E_est']} | {row['gamma 2.2']} | {row['uncertainty']} |"
        for camera, row in real["groups"].items()
    ]
    mean = {name: sum(row[name] for row in real["groups"].values()) / len(cameras) for name in ("E_est", "gamma 2.2")}
    parts = [
        INTRODUCTION.format(**entries),
        "## Accuracy\n",
        "P0: 20 held-out scenes x 201 DoRF curves, each at one of five exposures (s_crf x 0.6 to 1.4), 8 bits.",
        "P4: real photographs with measured responses; nothing was chosen on them. E_lin is x 1e-2. To compare: the",
        "mean of the 201 curves has an E_est of 2.91 on P0, the paper's network (trained on other scenes) 1.61.\n",
        "| | P0 | P4 |\n| --- | --- | --- |",
        *rows,
        "\n| camera (P4) | photographs | E_est | gamma 2.2 | uncertainty |\n| --- | --- | --- | --- | --- |",
        *cameras,
        f"| **mean of the cameras** | | **{mean['E_est']:.2f}** | **{mean['gamma 2.2']:.2f}** | |",
        "\nMade by `make model DATA=<folder of the data>`; see `training/README.md`.",
    ]
    return "\n".join(parts) + "\n"


def main() -> None:
    """Write the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", type=Path, required=True)
    parser.add_argument("--p0", type=Path, required=True)
    parser.add_argument("--real", type=Path, required=True)
    options = parser.parse_args()
    p0, real = (json.loads(path.read_text()) for path in (options.p0, options.real))
    config = ModelConfig.read(options.model / "model.json")
    config = replace(config, accuracy={"P0": p0["summary"], "P4": real["summary"]})
    config.write(options.model / "model.json")
    text = card(options.model, config, real)
    write_text_whole(options.model / "README.md", text, overwrite=True)
    print(text)


if __name__ == "__main__":
    main()

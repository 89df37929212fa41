"""Average the weights of related runs: ``python -m training.network.average --run DIR DIR --share A B --out DIR``.

Networks that were trained from the same weights, or one from the other, lie in one valley of the loss. The mean of
their weights is one network that answers nearly as well as the mean of their answers: Wortsman et al., "Model soups",
ICML 2022. A mean with the network before also keeps what the later run forgets: "Robust fine-tuning of zero-shot
models", CVPR 2022.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import torch
from torch import Tensor

from crfnet_core.files import atomic_write
from training.network.model import NetworkConfig, PhotographNet
from training.network.start import start_from, start_record
from training.network.train import CHECKPOINT
from training.provenance import RUN_FILE, Record, read_run, write_json


def average(runs: Sequence[Path], shares: Sequence[float], out: Path) -> Path:
    """Write a run folder with the weighted mean of the last checkpoints of runs, and return its checkpoint.

    Runs are folders of `training.network.train`, or model folders; each has a share, relative to the sum of all. The
    run.json of `out` comes from the run with the largest share, and names all of them under "average". Raise SystemExit
    if the networks differ in size or are not related, or the numbers of runs and shares differ.
    """
    if len(shares) != len(runs) or min(shares) <= 0:
        raise SystemExit("give each run a share above 0")
    records = [read_run(run) for run in runs]
    if not _are_related(runs, records):
        raise SystemExit(
            "these runs cannot be averaged: their networks differ in size or in the weights they began from"
        )
    networks = [_weights(run, record) for run, record in zip(runs, records, strict=True)]
    parts = [share / sum(shares) for share in shares]
    out.mkdir(parents=True, exist_ok=True)
    with atomic_write(out / CHECKPOINT, overwrite=True) as temporary:
        torch.save({"net": weighted_mean(networks, parts)}, temporary)
    largest = records[parts.index(max(parts))]
    write_json(out / RUN_FILE, largest | {"average": [_part(*one) for one in zip(runs, records, parts, strict=True)]})
    return out / CHECKPOINT


def weighted_mean(networks: Sequence[dict[str, Tensor]], parts: Sequence[float]) -> dict[str, Tensor]:
    """Return the weighted mean of the states of networks; whole numbers (counts of batches) come from the first."""
    return {
        name: sum(
            (part * network[name] for part, network in zip(parts, networks, strict=True)), torch.zeros_like(first)
        )
        if first.is_floating_point()
        else first
        for name, first in networks[0].items()
    }


def _are_related(runs: Sequence[Path], records: Sequence[Record]) -> bool:
    """Return whether all networks have one size, and began from the same weights or from one of the others."""
    sizes = {json.dumps(record["recipe"]["network"], sort_keys=True) for record in records}
    starts = {record["start"] for record in records} - {start_record(_source(run)) for run in runs}
    return len(sizes) == 1 and len(starts) == 1


def _source(folder: Path) -> Path:
    """Return what another run is given to start from this one: the folder of a model, or the checkpoint of a run."""
    return folder if _is_model(folder) else folder / CHECKPOINT


def _is_model(folder: Path) -> bool:
    """Return whether a folder holds an exported model, not a run."""
    return not (folder / CHECKPOINT).exists()


def _weights(folder: Path, record: Record) -> dict[str, Tensor]:
    """Return the weights of a run, or of a model folder."""
    if not _is_model(folder):
        return dict(torch.load(folder / CHECKPOINT, weights_only=True)["net"])
    net = PhotographNet(NetworkConfig(**record["recipe"]["network"]))
    start_from(net, folder)
    return dict(net.state_dict())


def _part(run: Path, record: Record, part: float) -> Record:
    """Return what is recorded of one of the runs."""
    return {
        "share": round(part, 6),
        "checkpoint": start_record(_source(run)),
        "commit": record["commit"],
        "recipe": record["recipe"],
        "data": {key: record["data"][key] for key in ("files", "sha256")},
    }


def main() -> None:
    """Average as the options say."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--run", type=Path, nargs="+", required=True, help="folders of runs or of models")
    parser.add_argument("--share", type=float, nargs="+", required=True, help="what each run counts")
    parser.add_argument("--out", type=Path, required=True, help="the new run folder")
    options = parser.parse_args()
    print(average(options.run, options.share, options.out))


if __name__ == "__main__":
    main()

"""Average the weights of related runs: ``python -m training.network.average --run DIR DIR --share A B --out DIR``.

Networks that were trained from the same weights, or one from the other, lie in one valley of the loss. The mean of
their weights is one network that answers nearly as well as the mean of their answers: Wortsman et al., "Model soups",
ICML 2022. A mean with the network before also keeps what the later run forgets: "Robust fine-tuning of zero-shot
models", CVPR 2022.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import torch
from torch import Tensor

from crfnet_core.files import atomic_write
from training.network.model import NetworkConfig, PhotographNet
from training.network.start import read_weights, start_record
from training.network.train import CHECKPOINT
from training.provenance import RUN_FILE, Record, read_run, write_json


def average(runs: Sequence[Path], shares: Sequence[float], out: Path) -> Path:
    """Write a run folder with the weighted mean of the last checkpoints of runs, and return its checkpoint.

    Runs are folders of `training.network.train`, or of models. The run.json of `out` comes from the run with the
    largest share, and names all under "average". Raise SystemExit if the networks differ in size or are not related.
    """
    if len(shares) != len(runs) or min(shares) <= 0:
        raise SystemExit("give each run a share above 0")
    records = [read_run(run) for run in runs]
    sources = [run / CHECKPOINT if (run / CHECKPOINT).exists() else run for run in runs]
    if not _are_related(sources, records):
        raise SystemExit("these runs cannot be averaged: their networks differ in size or in their first weights")
    net = PhotographNet(NetworkConfig(**records[0]["recipe"]["network"]))
    networks = [net.state_dict() | read_weights(net, source) for source in sources]
    parts = [share / sum(shares) for share in shares]
    out.mkdir(parents=True, exist_ok=True)
    with atomic_write(out / CHECKPOINT, overwrite=True) as temporary:
        torch.save({"network": weighted_mean(networks, parts)}, temporary)
    largest = records[parts.index(max(parts))]
    averaged = [
        {
            "share": round(part, 6),
            "checkpoint": start_record(source),
            "commit": record["commit"],
            "recipe": record["recipe"],
            "data": {key: record["data"][key] for key in ("files", "sha256")},
        }
        for source, record, part in zip(sources, records, parts, strict=True)
    ]
    write_json(out / RUN_FILE, largest | {"average": averaged})
    return out / CHECKPOINT


def weighted_mean(networks: Sequence[dict[str, Tensor]], parts: Sequence[float]) -> dict[str, Tensor]:
    """Return the weighted mean of the states of networks; whole numbers (counts of batches) come from the first."""
    mean = dict(networks[0])
    for name, first in networks[0].items():
        if first.is_floating_point():
            mean[name] = sum(part * network[name] for part, network in zip(parts, networks, strict=True))
    return mean


def _are_related(sources: Sequence[Path], records: Sequence[Record]) -> bool:
    """Return whether all networks have one size, and began from the same weights or from one of the others."""
    sizes = {json.dumps(record["recipe"]["network"], sort_keys=True) for record in records}
    starts = {record["start"] for record in records} - {start_record(source) for source in sources}
    return len(sizes) == 1 and len(starts) == 1


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

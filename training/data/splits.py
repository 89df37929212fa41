"""Which scenes and which curves are held out: splits.json, which never changes, and the rules that it was made by.

Scenes are split in `training.data.scenes`. Curves are held out by whole groups, because some curves of DoRF are nearly
equal.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage

from crfnet_core.errors import CRFNetError
from crfnet_core.types import Float64Array, IndexArray
from training.data.curves import read_dorf
from training.data.scenes import SPLIT_SEED, split_scenes

#: The splits that the packaged models were trained and measured with.
SPLITS_FILE = Path(__file__).with_name("splits.json")

GROUP_DIAMETER = 1.0  # no two curves of a group are farther apart than this, in units of E_est
HELD_OUT_FRACTION = 0.2  # fraction of the curves that P2 holds out, rounded down to whole groups


def curve_groups(dorf: Float64Array) -> IndexArray:
    """Return the group of each curve, int (N,), numbered from 0 in order of first appearance.

    Complete-linkage clustering on the L2 distance: no two curves of a group are farther apart than `GROUP_DIAMETER`.
    The 201 curves of DoRF, (201, 1024) at uniform irradiances, fall into 48 groups.
    """
    labels = fcluster(linkage(dorf, method="complete"), GROUP_DIAMETER, criterion="distance")
    _, first, groups = np.unique(labels, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[groups]


def held_out_curves(dorf: Float64Array) -> IndexArray:
    """Return the sorted indices of the curves that P2 holds out: random whole groups, up to a fifth of the curves."""
    groups = curve_groups(dorf)
    sizes, room = np.bincount(groups), round(HELD_OUT_FRACTION * len(dorf))
    chosen = []
    for group in np.random.default_rng(SPLIT_SEED).permutation(len(sizes)):
        if sizes[group] <= room:
            chosen.append(group)
            room -= sizes[group]
    return np.flatnonzero(np.isin(groups, chosen))


def compute_splits(data: Path) -> dict[str, Any]:
    """Return the entries of splits.json for the scenes and curves in the folder `data`."""
    dorf = read_dorf(data)
    scenes = split_scenes(data / "linear", with_imported=False)
    return {
        "seed": SPLIT_SEED,
        "scenes": {split: [name for name, _ in members] for split, members in scenes.items()},
        "curve_group_diameter": GROUP_DIAMETER,
        "curve_groups": curve_groups(dorf).tolist(),
        "held_out_curves": held_out_curves(dorf).tolist(),
    }


def checked_splits(data: Path) -> dict[str, Any]:
    """Return the splits in splits.json; CRFNetError if scenes or curves in the folder `data` are split otherwise."""
    splits: dict[str, Any] = json.loads(SPLITS_FILE.read_text())
    computed = compute_splits(data)
    differing = [name for name in splits if splits[name] != computed[name]]
    if differing:
        raise CRFNetError(f"{data}: {' and '.join(differing)} differ from {SPLITS_FILE.name}; restore the data")
    return splits

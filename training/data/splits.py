"""Which scenes and which curves are held out: splits.json, which never changes.

Scenes were drawn at random: a quarter of the perspective photographs for the test split, none for the validation split;
panoramas fill up both. Curves are held out by random whole groups, because some curves of DoRF are nearly equal.
"""

import json
from pathlib import Path
from typing import Any

from scipy.cluster.hierarchy import fcluster, linkage

from crfnet_core.errors import CRFNetError
from crfnet_core.types import Float64Array
from training.data.curves import read_dorf
from training.data.scenes import Scene, read_scene, table_rows

#: The splits that the packaged models were trained and measured with: "scenes" (split -> files), "curve_groups" (the
#: group of each curve), and "held_out_curves" (the numbers of the curves that P2 holds out).
SPLITS: dict[str, Any] = json.loads(Path(__file__).with_name("splits.json").read_text())


def split_scenes(folder: Path, *, with_imported: bool = True) -> dict[str, list[tuple[str, bool]]]:
    """Return split name -> (file, is panorama) of every scene in the folder's manifest.csv, in the order of `SPLITS`.

    Scenes that `SPLITS` does not name, such as imported ones, are listed if `with_imported`, and only train.
    """
    is_panorama = {row["file"]: row["kind"] == "panorama band" for row in table_rows(folder / "manifest.csv")}
    names = {split: [name for name in files if name in is_panorama] for split, files in SPLITS["scenes"].items()}
    if with_imported:
        names["train"] += sorted(is_panorama.keys() - {name for files in names.values() for name in files})
    return {split: [(name, is_panorama[name]) for name in files] for split, files in names.items()}


def read_scenes(folder: Path, split: str) -> list[Scene]:
    """Return the scenes of a split, from the EXR files of `folder`; CRFNetError if it has none."""
    scenes = split_scenes(folder)[split]
    if not scenes:
        raise CRFNetError(f"{folder}: too few scenes, none is left for the split {split}; add to the published ones")
    return [read_scene(folder / name, is_panorama) for name, is_panorama in scenes]


def check_splits(data: Path) -> None:
    """Raise CRFNetError if the folder `data` lacks a published scene, or its curves fall into other groups."""
    scenes = split_scenes(data / "linear", with_imported=False)
    found = {
        "scenes": {split: [name for name, _ in files] for split, files in scenes.items()},
        "curve_groups": curve_groups(read_dorf(data)),
    }
    differing = [name for name in found if found[name] != SPLITS[name]]
    if differing:
        raise CRFNetError(f"{data}: {' and '.join(differing)} differ from splits.json; restore the data")


def curve_groups(dorf: Float64Array) -> list[int]:
    """Return the group of each curve, numbered from 0 in order of first appearance.

    Complete-linkage clustering on the L2 distance: no two curves of a group are farther apart than
    "curve_group_diameter" of `SPLITS`, in units of E_est. The 201 curves of DoRF fall into 48 groups.
    """
    labels = fcluster(linkage(dorf, method="complete"), SPLITS["curve_group_diameter"], criterion="distance")
    numbers = {label: number for number, label in enumerate(dict.fromkeys(labels))}
    return [numbers[label] for label in labels]

"""Say whether simulated photographs can be told from real ones: ``python -m training.realism --data DATA``.

A classifier learns to tell photographs of DATA/real_bodies from simulated ones with the measured responses of the same
bodies, from the features that the network reads, by cue. It is judged on other bodies and on other scenes. Real
photographs of three kinds are compared with plain captures and with simulated ones of the same kind: point-sampled
ones, those made small before, and crops at full resolution. A last row tells simulated photographs of panoramas from
those of perspective scenes, which differ in their subjects only: so much is not the camera's fault.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from crfnet_core.types import Float32Array
from training.data.curves import CurveSource
from training.data.scenes import Scene, read_scenes
from training.realism.classifier import separation, single_aucs
from training.realism.feature_names import feature_names
from training.realism.samples import (
    ALL,
    CUES,
    RealSet,
    SampleSet,
    measured_responses,
    real_samples,
    simulated_samples,
)
from training.synthesis.camera import reference_luminance
from training.synthesis.camera_draws import CameraShares, FrameKind

#: The kind of frame that is compared with each set of real photographs.
KINDS = {
    RealSet.SAMPLED: FrameKind.SAMPLED,
    RealSet.SMALL: FrameKind.SCALED,
    RealSet.CROPS: FrameKind.NATIVE,
}


def table(real: dict[RealSet, SampleSet], simulated: dict[FrameKind, SampleSet]) -> list[str]:
    """Return the lines of a Markdown table: the AUC of every comparison, by cue."""
    lines = ["| real | simulated | " + " | ".join((*CUES, ALL)) + " |", "| --- " * (3 + len(CUES)) + "|"]
    for against, kind in KINDS.items():
        for shown in (FrameKind.PLAIN, kind):
            if shown in simulated:
                lines.append(_row(against, shown, simulated[shown], real[against]))
    return lines


def subject_row(scenes: list[Scene], curves: CurveSource, luminance: Float32Array, *, count: int, seed: int) -> str:
    """Return a line of the table: plain captures of panoramas and of perspective scenes, as many of each."""
    perspective = [scene for scene in scenes if not scene.is_panorama]
    panoramas = [scene for scene in scenes if scene.is_panorama][: len(perspective)]
    first, second = (
        simulated_samples(part, curves, CameraShares.only(FrameKind.PLAIN), luminance, count=count, seed=seed)
        for part in (panoramas, perspective)
    )
    return _row("simulated: perspective scenes", "panoramas", first, second)


def _row(against: str, shown: str, first: SampleSet, second: SampleSet) -> str:
    """Return a line of the table: what is told apart, and the separation by each cue and by all."""
    areas = (separation(first.features[cue], second.features[cue], first.groups, second.groups) for cue in (*CUES, ALL))
    return "| " + " | ".join([against, shown, *map(str, areas)]) + " |"


def separating(first: SampleSet, second: SampleSet, *, count: int = 12) -> list[str]:
    """Return lines on the groups of features that separate most, one feature at a time."""
    names = feature_names()
    areas = single_aucs(first.features[ALL], second.features[ALL])
    groups: dict[str, list[float]] = {}
    for name, area in zip(names, areas, strict=True):
        groups.setdefault(name, []).append(area)
    means = {name: (float(np.mean(np.abs(np.array(a) - 0.5)) + 0.5), float(np.mean(a))) for name, a in groups.items()}
    ordered = sorted(means.items(), key=lambda item: -item[1][0])[:count]
    return [f"- {name}: {either:.2f} (real above simulated {above:.2f})" for name, (either, above) in ordered]


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="python -m training.realism", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf, camera_curves, linear, real_bodies")
    parser.add_argument("--split", default="validation", choices=["train", "validation"], help="of the scenes")
    parser.add_argument("--photographs", type=int, default=150, help="simulated photographs of each kind")
    parser.add_argument("--kind", nargs="+", type=FrameKind, default=list(FrameKind), choices=list(FrameKind))
    parser.add_argument("--seed", type=int, default=2017)
    options = parser.parse_args()
    real, scenes = real_samples(options.data), read_scenes(options.data / "linear", options.split)
    curves, luminance = measured_responses(options.data), reference_luminance(scenes)
    simulated = {
        kind: simulated_samples(
            scenes, curves, CameraShares.only(kind), luminance, count=options.photographs, seed=options.seed
        )
        for kind in options.kind
    }
    known = read_scenes(options.data / "linear", "train")
    subjects = subject_row(known, curves, luminance, count=options.photographs, seed=options.seed)
    print("\n".join([*table(real, simulated), subjects]))
    for against, kind in KINDS.items():
        if kind in simulated:
            print(f"\n{against}, {kind}: features that separate most")
            print("\n".join(separating(simulated[kind], real[against])))


if __name__ == "__main__":
    main()

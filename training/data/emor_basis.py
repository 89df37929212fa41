"""Compute crfnet_core/data/emor.npz from the DoRF curves: ``python -m training.data.emor_basis --data DIR``."""

import argparse
from pathlib import Path

import numpy as np

from crfnet_core.files import atomic_write
from crfnet_core.response.curve import SAMPLES
from crfnet_core.response.emor import BASIS_FILE, EmorBasis
from crfnet_core.types import Float64Array
from training.data.curves import DORF_FILE, EMOR_FILE, read_dorf

#: Least |cosine| between each of the first five components and the published one.
LEAST_COSINE = 0.999


def main() -> None:
    """Compute the basis, compare it with the published one, and write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help=f"folder with {DORF_FILE} and {EMOR_FILE}")
    data = parser.parse_args().data
    basis = EmorBasis.from_curves(read_dorf(data))
    published = read_published(data / EMOR_FILE)
    cosines = np.abs(np.sum(basis.components * published[1 : 1 + len(basis.components)], axis=1))
    print("|cosine| with the published components:", np.round(cosines, 5))
    print(f"mean differs by at most {np.abs(basis.mean - published[0]).max():.4f}")
    if cosines[:5].min() < LEAST_COSINE:
        raise SystemExit(f"the first five components must agree with the published ones to {LEAST_COSINE}")
    with atomic_write(BASIS_FILE, overwrite=True) as temporary:
        np.savez(temporary, mean=basis.mean, components=basis.components)
    print(f"wrote {BASIS_FILE.name}")


def read_published(path: Path) -> Float64Array:
    """Return f0 and the unit components of emor.txt, shape (26, 1024)."""
    blocks = path.read_text().split("=")[2:]
    values = np.array([[float(word) for word in block.split()[:SAMPLES]] for block in blocks])
    return np.vstack([values[:1], values[1:] / np.linalg.norm(values[1:], axis=1, keepdims=True)])


if __name__ == "__main__":
    main()

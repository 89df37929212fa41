"""Hashes of what the project writes, to show that a change of its structure changes no result.

``python -m tests.freeze --check`` compares with tests/data/frozen.json, ``--write`` replaces it; ``--data FOLDER`` adds
the photographs in FOLDER/real/input. Versions of libraries change rounding: compare on one machine and environment.
"""

import argparse
import hashlib
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
FROZEN = ROOT / "tests" / "data" / "frozen.json"

#: Files that only a release of a model may change; the tests compare the code with them.
GOLDEN = ("tests/data/golden_statistics.npz", "crfnet_core/models/*/golden_predictions.npz", "crfnet_core/data/*.npz")


def main():
    """Compare or write the hashes; the exit code is the number of differences, at most 1."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--data", type=Path, help="the folder that has real/input")
    parser.add_argument("--module", default="crfnet", help="the module that is run as the command")
    arguments = parser.parse_args()
    found = golden_files() | demo_files(arguments.module)
    if arguments.data:
        found |= real_photographs(arguments.module, arguments.data)
    if arguments.write:
        FROZEN.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n", encoding="utf-8")
        return 0
    frozen = json.loads(FROZEN.read_text(encoding="utf-8"))
    if not arguments.data:
        frozen = {name: digest for name, digest in frozen.items() if not name.startswith("real/")}
    changed = [name for name in sorted(frozen.keys() | found.keys()) if frozen.get(name) != found.get(name)]
    print(*(f"changed: {name}" for name in changed), f"{len(found)} compared, {len(changed)} changed", sep="\n")
    return int(bool(changed))


def golden_files():
    """Return the hashes of the packaged results that the tests compare the code with."""
    paths = sorted(path for pattern in GOLDEN for path in ROOT.glob(pattern))
    return {str(path.relative_to(ROOT)): digest(path.read_bytes()) for path in paths}


def demo_files(module):
    """Return the hashes of every file that `estimate` writes for the bundled plate, without the sheet."""
    with tempfile.TemporaryDirectory() as folder:
        plate = Path(folder, "plate.jpg")
        plate.write_bytes((ROOT / "tests/data/plate.jpg").read_bytes())
        run(module, "estimate", plate.name, "--out", "out", "--no-sheet", "--forward", cwd=folder)
        return {f"demo/{path.name}": digest(path.read_bytes()) for path in sorted(Path(folder, "out").iterdir())}


def real_photographs(module, data):
    """Return the hash of the JSON that `estimate --json` prints for each photograph."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for photo in sorted((data / "real" / "input").iterdir()):
            shutil.copy(photo, folder)
            options = ["--out", "out", "--no-sheet", "--no-linear", "--json", "--overwrite"]
            found[f"real/{photo.stem}"] = digest(run(module, "estimate", photo.name, *options, cwd=folder))
    return found


def run(module, *arguments, cwd):
    """Return what a command prints."""
    command = [sys.executable, "-m", module, *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout


def digest(content):
    """Return the SHA-256 of bytes, in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


if __name__ == "__main__":
    sys.exit(main())

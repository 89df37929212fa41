"""The record of a training run: code, data, recipe, seed and versions, kept in `run.json` in its folder.

The makers of data (`training.network.shards`, `training.crfnet2017.windows`) leave `made_SPLIT.json` in its folder. The
record of the run holds these, too, so it reaches back to the files of `training/data/manifest.csv`.
"""

import hashlib
import json
import platform
import subprocess
import sys
from collections.abc import Iterable
from importlib.metadata import version
from pathlib import Path
from typing import Any

from crfnet_core.files import atomic_write_text, file_sha256

RUN_FILE = "run.json"  # the record of a run in its folder, and in the folder of a model that came from it
ROOT = Path(__file__).parents[1]  # the root of the repository

Record = dict[str, Any]


def record_run(folder: Path, *, recipe: Record, seed: int, data: Record, start: str) -> Record:
    """Write run.json for a run that begins; for one that goes on, check it and add the resumption; return the record.

    `recipe` is the whole configuration, in values that JSON knows; `data` comes from `data_record`, and `start` names
    the weights that the run starts from. Raise SystemExit if the folder holds a run that differs in one of these.
    """
    wanted = json.loads(json.dumps({"seed": seed, "start": start, "recipe": recipe, "data": data}))
    path = folder / RUN_FILE
    if path.exists():
        record: Record = json.loads(path.read_text())
        found, settings = _settings(record), _settings(wanted)
        differing = sorted(name for name in settings if found.get(name) != settings[name])
        if differing:
            raise SystemExit(f"{folder}: holds a run of another {', '.join(differing)}; take another folder")
        record["resumed"].append(code_record())
    else:
        record = {"recorded": "when the run began"} | code_record() | wanted | {"resumed": []}
    folder.mkdir(parents=True, exist_ok=True)
    write_json(path, record)
    return record


def read_run(folder: Path) -> Record:
    """Return the record of a run; SystemExit if the folder holds no run.json."""
    path = folder / RUN_FILE
    if not path.exists():
        raise SystemExit(f"{folder}: holds no {RUN_FILE}; give the folder of a training run")
    record: Record = json.loads(path.read_text())
    return record


def training_commit(record: Record) -> str:
    """Return the commit that a run began from; "-dirty" behind it says that files had been changed since."""
    return f"{record.get('commit') or 'unknown'}{'-dirty' if record.get('dirty') else ''}"


def data_record(folder: Path, files: Iterable[Path]) -> Record:
    """Return the number and the digest of the files that a run reads, and how they were made as far as it is known."""
    chosen = sorted(files)
    made = {p.stem.removeprefix("made_"): json.loads(p.read_text()) for p in sorted(folder.glob("made_*.json"))}
    names = "".join(f"{file_sha256(path)}  {path.name}\n" for path in chosen)
    return {"files": len(chosen), "sha256": hashlib.sha256(names.encode()).hexdigest(), "made": made}


def record_making(folder: Path, name: str, source_sha256: str) -> None:
    """Add a line to made_NAME.json: the code that makes files in `folder`, and the digest of the files it reads."""
    path = folder / f"made_{name}.json"
    made = json.loads(path.read_text()) if path.exists() else []
    write_json(path, [*made, code_record() | {"source_sha256": source_sha256}])


def code_record() -> Record:
    """Return the command, the commit, whether tracked files differ from it, and the versions of what computes."""
    changes = _git("status", "--porcelain", "--untracked-files=no")
    return {
        "command": ["python", *sys.orig_argv[1:]],
        "commit": _git("rev-parse", "HEAD"),
        "dirty": None if changes is None else bool(changes),
        "versions": {"python": platform.python_version(), "torch": version("torch"), "numpy": version("numpy")},
    }


def write_json(path: Path, entries: Record | list[Record]) -> None:
    """Write JSON, whole or not at all; an existing file is replaced."""
    atomic_write_text(path, json.dumps(entries, indent=2) + "\n", overwrite=True)


def _settings(record: Record) -> Record:
    """Return what must not change when a run goes on."""
    return record["recipe"] | {"seed": record["seed"], "start": record["start"], "data": record["data"]["sha256"]}


def _git(*arguments: str) -> str | None:
    """Return the output of a git command in the repository, or None without git or a repository."""
    try:
        done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.strip()

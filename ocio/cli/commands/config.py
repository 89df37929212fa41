"""`crfnet config`: plates in a studio's or a program's config."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ...configs.studio.additions import AdditionOptions, add_looks
from ...configs.studio.looks import Look, read_looks
from ...configs.studio.overlay import write_overlay
from ...configs.studio.plates import Changed, PlateInConfig, plates_in_config
from ...configs.studio.removal import remove_plates
from ...configs.studio.sources import find_config
from ...defaults import CONFIG_NAME
from ...errors import ConfigError
from .printing import print_json, print_lines


def run(arguments: argparse.Namespace) -> None:
    """Do what `crfnet config add`, `list`, `remove` or `overlay` asks for."""
    actions: dict[str, Callable[[argparse.Namespace], None]] = {
        "add": _add,
        "list": _list,
        "remove": _remove,
        "overlay": _overlay,
    }
    actions[arguments.action](arguments)


def _add(arguments: argparse.Namespace) -> None:
    """Put plates into a config."""
    looks = _looks(arguments.looks)
    rules = (*arguments.rule, *arguments.linear_rule)
    if rules and (arguments.no_rules or len(looks) > 1):
        raise ConfigError("--rule and --linear-rule are for one plate; give one LOOK, and no --no-rules")
    if not all(rules):
        raise ConfigError("a rule's PATTERN is empty; give the names of files")
    options = AdditionOptions(
        patterns=tuple(arguments.rule),
        linear_patterns=tuple(arguments.linear_rule),
        has_rules=not arguments.no_rules,
        has_views=arguments.view,
        overwrite=arguments.overwrite,
    )
    done = add_looks(find_config(arguments.base), _target(arguments.out), looks, options)
    if arguments.json:
        print_json(_change_document(done))
        return
    words = "Written:" if done.is_changed else "Nothing to do, all of it is there already:"
    print_lines([f"{words} {done.config}", *_backup_lines(done), *_plate_lines(done.plates)])
    print_lines(f"note: {note}" for note in done.notes)


def _list(arguments: argparse.Namespace) -> None:
    """List the plates of a config."""
    source = find_config(arguments.config)
    plates = plates_in_config(source.config)
    if arguments.json:
        print_json({"config": source.name, "plates": [asdict(plate) for plate in plates]})
    else:
        print_lines(_plate_lines(plates) if plates else [f"{source.name}: has no plates"])


def _remove(arguments: argparse.Namespace) -> None:
    """Take plates out of a config."""
    done = remove_plates(find_config(arguments.config), arguments.names)
    if arguments.json:
        print_json(_change_document(done))
    else:
        names = ", ".join(plate.name for plate in done.plates)
        print_lines([f"Taken out of {done.config}: {names}", *_backup_lines(done)])


def _overlay(arguments: argparse.Namespace) -> None:
    """Write a config of plates alone, and a merge file."""
    target = _target(arguments.out)
    assert target is not None  # --out is required
    base = find_config(arguments.base)
    done = write_overlay(base, target, _looks(arguments.looks), overwrite=arguments.overwrite)
    if arguments.json:
        plates = [asdict(plate) for plate in done.plates]
        print_json({"config": str(done.config), "merge_file": str(done.merge_file), "plates": plates})
        return
    merged = done.config.with_name("merged.ocio")
    print_lines([f"Written: {done.config}", f"         {done.merge_file}", *_plate_lines(done.plates), ""])
    print_lines(["Merge with OpenColorIO 2.5 or later, into the same folder:"])
    print_lines([f"  ociomergeconfigs '{done.merge_file}' --out '{merged}' --validate"])


def _looks(paths: Iterable[Path]) -> list[Look]:
    """Return the looks in folders, documents and LUTs, each once."""
    looks = [look for path in paths for look in read_looks(path)]
    return list({look.source: look for look in looks}.values())


def _target(out: Path | None) -> Path | None:
    """Return the config's file: --out itself, or a `CONFIG_NAME` in that folder."""
    return out if out is None or out.suffix.lower() == ".ocio" else out / CONFIG_NAME


def _backup_lines(done: Changed) -> list[str]:
    """Return the line that names the backup."""
    return [f"The config as it was: {done.backup}"] if done.backup else []


def _plate_lines(plates: Iterable[PlateInConfig]) -> list[str]:
    """Return the lines that describe plates."""
    lines = []
    for plate in plates:
        exposure = f", {plate.exposure:+g} stops" if plate.exposure else ""
        lines.append(f"{plate.name}: {plate.lut_file}{exposure}")
        lines += [f"  rule: {regex} -> {space}" for regex, space in plate.rules.items()]
        lines += [f"  view: {view}" for view in plate.views]
    return lines


def _change_document(done: Changed) -> dict[str, Any]:
    """Return what was done, ready for JSON."""
    return {
        "config": str(done.config),
        "plates": [asdict(plate) for plate in done.plates],
        "is_changed": done.is_changed,
        "backup": str(done.backup) if done.backup else None,
        "notes": list(done.notes),
    }

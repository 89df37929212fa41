"""`crfnet config`: plates in a config that is built on another one."""

import argparse
from collections.abc import Iterable
from dataclasses import asdict

from ...configs.derived import write_derived_config
from ...configs.looks import read_looks
from ...configs.plate_color_space import PlateInConfig, plates_in_config
from ...configs.sources import find_config
from ...luts.rgb_lut import lut_identity
from .printing import lost_document, lost_lines, print_result


def run(arguments: argparse.Namespace) -> None:
    """Run `crfnet config add` or `list`."""
    {"add": _add, "list": _list}[arguments.action](arguments)


def _add(arguments: argparse.Namespace) -> None:
    read = [look for path in arguments.looks for look in read_looks(path)]
    looks = list({(look.folder, look.space, lut_identity(look.lut)): look for look in read}.values())  # each once
    base = find_config(arguments.base)
    derived = write_derived_config(base, arguments.out, looks, overwrite=arguments.overwrite)
    plates = [asdict(plate) for plate in derived.plates]
    document = {"config": str(derived.path), "plates": plates, "without_rule": list(derived.without_rule)}
    reason = "many cameras give such names, several plates have it, or the config has no space for it"
    if base.config.getMajorVersion() < 2:
        reason = "its base, of profile version 1, has no file rules"
    notes = [f"note: file rules give {pattern} no space of its own: {reason}" for pattern in derived.without_rule]
    notes += lost_lines(derived.path, derived.dropped)
    lines = [f"Written: {derived.path}", *_plate_lines(derived.plates), *notes]
    print_result(document | lost_document(derived.dropped), lines, as_json=arguments.json)


def _list(arguments: argparse.Namespace) -> None:
    source = find_config(arguments.config)
    plates = plates_in_config(source.config)
    document = {"config": source.name, "plates": [asdict(plate) for plate in plates]}
    lines = _plate_lines(plates) or [f"{source.name}: has no plates"]
    print_result(document, lines, as_json=arguments.json)


def _plate_lines(plates: Iterable[PlateInConfig]) -> list[str]:
    """Return the lines that describe plates."""
    lines = []
    for plate in plates:
        exposure = f", {plate.exposure:+g} stops" if plate.exposure else ""
        lines.append(f"{plate.name}: {plate.lut_file}{exposure}")
        lines += [f"  file rule {regex}: {space}" for regex, space in plate.rules.items()]
    return lines

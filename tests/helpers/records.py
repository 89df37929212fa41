"""The records of many photographs, as `crfnet estimate --each` and `linearize --each` append them."""

import json

import PyOpenColorIO as OCIO

from crfnet.configs.file_rules import FAMILY


def plates_in(folder):
    """Return the photographs in the config of an output folder, by the names of their color spaces."""
    spaces = OCIO.Config.CreateFromFile(str(folder / "config.ocio")).getColorSpaces()
    return [space.getName().removeprefix("CRF ") for space in spaces if space.getFamily() == FAMILY]


def records_in(folder):
    """Return the last record of each photograph in an output folder."""
    (path,) = folder.glob("*.jsonl")
    records = [json.loads(line) for line in path.read_bytes().split(b"\n")[:-1]]
    return list({record["place"]: record for record in records}.values())

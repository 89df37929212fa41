"""The records of many photographs, as `crfnet estimate --each` and `linearize --each` append them."""

import json


def records_in(folder):
    """Return the last record of each photograph in an output folder."""
    (path,) = folder.glob("*.jsonl")
    records = [json.loads(line) for line in path.read_bytes().split(b"\n")[:-1]]
    return list({record["place"]: record for record in records}.values())

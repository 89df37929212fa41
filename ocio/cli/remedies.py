"""Remedies for errors that name an option of the command: the libraries' sentences name none."""

from __future__ import annotations

from collections.abc import Mapping

#: Code of an error -> text behind its sentence and "; ".
REMEDIES: Mapping[str, str] = {
    # movies and plates
    "exr_untagged": "add --encoded",
    "finished_differs": "add --overwrite or change --out",
    "primaries_differ": "or give the primaries of all with --primaries",
    "primaries_unknown": "say what they are: --primaries",
    "single_file": "leave --frames out",
}

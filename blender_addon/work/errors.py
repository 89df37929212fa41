# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors of the add-on itself; those of the estimator are `crfnet_core.errors.CRFNetError`."""

from __future__ import annotations

import sys


class AddonError(Exception):
    """Something that the user can mend, in one sentence."""


class CancelledError(AddonError):
    """The user cancelled a run."""


def expected_errors() -> tuple[type[Exception], ...]:
    """Return the errors whose text is meant for the user; the core's are among them once it is loaded."""
    core = sys.modules.get("crfnet_core.errors")
    return (AddonError,) if core is None else (AddonError, core.CRFNetError)

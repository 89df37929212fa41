# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors of the add-on itself.

They are not `crfnet_core.errors.CRFNetError`, because the add-on must report that the estimator cannot be imported.
"""

import sys


class AddonError(Exception):
    """A problem that the user can solve; the message is one line, with the remedy."""


class CancelledError(AddonError):
    """The user cancelled a job."""


def expected_errors() -> tuple[type[Exception], ...]:
    """Return the errors whose messages are written for the user, the estimator's among them once it is imported."""
    core = sys.modules.get("crfnet_core.errors")
    return (AddonError,) if core is None else (AddonError, core.CRFNetError)

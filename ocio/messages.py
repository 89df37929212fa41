"""Every sentence that the errors of `ocio` say, each once, by its code; see `crfnet_core.messages` for the rules."""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {}

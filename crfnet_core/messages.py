"""Every sentence that the errors and notices of `crfnet_core` say, each once, by its code.

A sentence says what was found, what was needed and what to do, on one line, in the terms of the library: it names no
option of the command and no button of Blender. Names in braces are the facts of the case.
"""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {}

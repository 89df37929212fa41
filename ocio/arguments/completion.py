"""`crfnet completion`: its arguments."""

from __future__ import annotations

import shtab

from ocio.arguments.parts import Commands, add_command

EXAMPLES = """examples:
  crfnet completion bash > ~/.local/share/bash-completion/completions/crfnet
  crfnet completion zsh > ~/.zfunc/_crfnet"""


def add(commands: Commands) -> None:
    """Add `crfnet completion`."""
    parser = add_command(commands, "completion", "print the shell completion script", EXAMPLES)
    parser.add_argument("shell", choices=shtab.SUPPORTED_SHELLS)

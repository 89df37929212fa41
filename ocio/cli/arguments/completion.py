"""`crfnet completion`: its arguments."""

from __future__ import annotations

from .parts import Commands, add_command

#: Shells that shtab knows, which is not imported here: that takes a third as long as all of --help.
SHELLS = ("bash", "zsh", "fish")

EXAMPLES = """examples:
  crfnet completion bash > ~/.local/share/bash-completion/completions/crfnet
  crfnet completion zsh > ~/.zfunc/_crfnet"""


def add(commands: Commands) -> None:
    """Add `crfnet completion`."""
    parser = add_command(commands, "completion", "print the shell completion script", EXAMPLES)
    parser.add_argument("shell", choices=SHELLS)

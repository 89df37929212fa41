"""The size of the project, as a table: ``python -m tests.size``.

Lines are those of Python files that git tracks; words those of Markdown files outside `tests/` and the model folders.
"""

import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[1]

#: Turns of phrase that this project used too often; see CONTRIBUTING, "Habits".
DIALECT = re.compile(r"\b(told|tells|those of|that of|is no)\b")


def main():
    """Print one line a figure."""
    files = [ROOT / name for name in git("ls-files", "-z").split("\0") if name and (ROOT / name).is_file()]
    python = [path for path in files if path.suffix == ".py"]
    tests = [path for path in python if is_in(path, "tests")]
    product = [path for path in python if path not in tests]
    texts = [path for path in files if path.suffix == ".md"]
    documents = [path for path in texts if not is_in(path, "tests") and not is_in(path, "crfnet_core/models")]
    for name, paths in rooms(product).items():
        print(f"{lines(paths):7} lines of {name}")
    print(f"{lines(product):7} lines of Python outside tests")
    print(f"{lines(tests):7} lines of tests")
    print(f"{words(documents):7} words of documents")
    print(f"{words([ROOT / 'README.md']):7} words of README")
    print(f"{len(options()):7} command-line options: {' '.join(options())}")
    print(f"{len(DIALECT.findall(joined([*python, *documents])))!s:>7} of told, tells, those of, that of, is no")


def git(*arguments):
    """Return what a git command prints."""
    return subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True).stdout


def is_in(path, folder):
    """Return whether a file is in a folder of the repository."""
    return path.is_relative_to(ROOT / folder)


def rooms(paths):
    """Return the files of each top-level folder."""
    found = {}
    for path in paths:
        found.setdefault(path.relative_to(ROOT).parts[0], []).append(path)
    return found


def lines(paths):
    """Return the number of lines of files."""
    return joined(paths).count("\n")


def words(paths):
    """Return the number of words of files."""
    return len(joined(paths).split())


def joined(paths):
    """Return the texts of files, one after the other."""
    return "".join(path.read_text(encoding="utf-8") for path in paths)


def options():
    """Return the distinct options of all subcommands."""
    text = joined((ROOT / "ocio/cli/arguments").glob("*.py"))
    return sorted(set(re.findall(r"\"(--[a-z][a-z-]+)\"", text)) | {"--help"})


if __name__ == "__main__":
    main()

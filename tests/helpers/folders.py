"""What lies in a folder."""


def listed(folder):
    """Return the names in a folder, sorted."""
    return sorted(path.name for path in folder.iterdir())


def tree(folder):
    """Return the bytes of every file below a folder, by its path relative to the folder with slashes."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}

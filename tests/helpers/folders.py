"""Write and change files, and see what lies in a folder."""


def written(path, content):
    """Write bytes, or text as UTF-8, and return the path."""
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def changed(path, old, new, *, to=None):
    """Write a file with other bytes in the place of those that it has once, to itself or to `to`; return the path."""
    content = path.read_bytes()
    assert content.count(old) == 1
    return written(to or path, content.replace(old, new))


def listed(folder):
    """Return the names in a folder, sorted."""
    return sorted(path.name for path in folder.iterdir())


def tree(folder):
    """Return the bytes of every file below a folder, by its path relative to the folder with slashes."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}

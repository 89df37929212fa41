"""The config that a user names: a file, a name of OpenColorIO's built-in configs, $OCIO, or an installed Blender."""

import os
import shutil
from dataclasses import dataclass
from pathlib import Path

import PyOpenColorIO as OCIO

from ..defaults import CONFIG_NAME
from ..errors import ConfigError
from .files import load_config

#: How OpenColorIO marks the names of built-in configs.
BUILT_IN = "ocio://"

#: The environment variable that names the config of every host, and how a user writes it.
VARIABLE, VARIABLE_NAMES = "OCIO", ("$OCIO", "${OCIO}", "%OCIO%")

#: Where Blender keeps its config: below the folder of its version, and on macOS below the application's Resources.
BLENDER_CONFIGS = tuple(
    f"{start}datafiles/colormanagement/{CONFIG_NAME}"
    for start in ("", "*/", "Contents/Resources/*/", "../Resources/*/")
)


@dataclass(frozen=True, eq=False)
class ConfigSource:
    """A config to build on, its name in messages, and its file; None if it is built into OpenColorIO."""

    config: OCIO.Config
    name: str
    path: Path | None


def find_config(name: str) -> ConfigSource:
    """Return the config that a user names.

    The name is a file, or a folder that holds a `CONFIG_NAME`; a built-in config, with or without "ocio://"; "$OCIO";
    or the folder or the executable of a Blender. Raise a ConfigError if there is none, or it cannot be loaded.
    """
    if name in VARIABLE_NAMES:
        if (value := os.environ.get(VARIABLE, "").strip()) in ("", *VARIABLE_NAMES):
            raise ConfigError("config_variable_unset", name=name, variable=VARIABLE)
        return find_config(value)
    if not name.startswith(BUILT_IN) and (path := _config_file(Path(name).expanduser())):
        if path.suffix.lower() == ".ocioz":
            raise ConfigError("config_archive", path=path)
        return ConfigSource(load_config(path), str(path), path)
    full = BUILT_IN + name.removeprefix(BUILT_IN)
    try:
        return ConfigSource(OCIO.Config.CreateFromFile(full), full, None)
    except (OCIO.Exception, OCIO.ExceptionMissingFile, UnicodeError):
        raise ConfigError("config_unknown", name=name, known=", ".join(built_in_names())) from None


def role_name(config: str, role: str) -> str:
    """Return the name of the color space that has a role in a config of `find_config`; a ConfigError if none has."""
    source = find_config(config)
    space = source.config.getColorSpace(role)
    if space is None:
        raise ConfigError("role_absent", path=source.name, role=role)
    return str(space.getName())


def built_in_names() -> tuple[str, ...]:
    """Return the names of OpenColorIO's built-in configs, the short ones first, each with "ocio://"."""
    configs = [entry[0] for entry in OCIO.BuiltinConfigRegistry().getBuiltinConfigs()]
    return tuple(BUILT_IN + name for name in ("default", "cg-config-latest", "studio-config-latest", *configs))


def _config_file(path: Path) -> Path | None:
    """Return the config file that a path means, or None; OpenColorIO looks for LUTs next to a link, not to its file."""
    if (path.is_file() and not os.access(path, os.X_OK)) or path.suffix.lower() in (".ocio", ".ocioz"):
        return path.absolute()
    if path.is_dir() and (path / CONFIG_NAME).is_file():
        return (path / CONFIG_NAME).absolute()
    executable = path if path.is_file() else Path(shutil.which(str(path)) or "")
    home = path if path.is_dir() else executable.resolve().parent if executable.is_file() else None
    matches = sorted(match for pattern in BLENDER_CONFIGS if home for match in home.glob(pattern))
    return matches[-1].resolve() if matches else None

"""Every sentence that the errors of `ocio` say, each once, by its code; see `crfnet_core.messages` for the rules."""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # configs
    "base_folder_is_variable": "{path}: OpenColorIO takes $ and % for variables; move the config that you build on",
    "base_would_change": "{path}: is the folder of the config that you build on, which stays as it is; choose another",
    "color_space_absent": "{name}: the config has no such color space; add it before writing",
    "color_space_exists": "{name}: the config uses this name for {taken!r}; choose another name",
    "color_space_refused": "{name}: cannot be added to the config ({reason})",
    "config_absent": "{path}: there is no such config; check the name",
    "config_aliases": "{path}: has more than {most} YAML aliases, each of which may multiply it; write them out",
    "config_archive": "{path}: is an archive; unpack it with OpenColorIO's ocioarchive and name the config in it",
    "config_differs_from_lut": "{name}: its conversion differs from its LUT by {difference:.2g}; write both again",
    "config_invalid": "{path}: not written, OpenColorIO refuses it ({reason})",
    "config_not_built_in": "{name}: is not built into this OpenColorIO; known are {known}",
    "config_refused": "{path}: OpenColorIO refuses this config ({reason}); mend it or choose another",
    "config_unknown": "{name}: is not a config, a built-in config's name or a Blender with one; built in are {known}",
    "config_unreadable": "{path}: cannot be read ({reason}); choose another config",
    "config_variable_unset": "{name}: the environment variable {variable} is not set; name a config",
    "config_without_rec709": (
        "the config has neither a space 'lin_rec709_scene' nor a role aces_interchange; add one of them"
    ),
    "exposure_not_finite": "{name}: the exposure must be a number of stops, found {exposure}",
    "folder_without_look": "{path}: holds no estimate; give the folder, the JSON or a LUT of one",
    "lut_name_is_variable": "{name}: OpenColorIO takes $ and % in {lut_file!r} for variables; rename it",
    "lut_outside_config_folder": "{name}: {lut_file!r} is not a name within the config's folder; put the LUT there",
    "lut_without_inverse_response": "{path}: {reason}",
    "nameless_color_space": "a color space needs a name, found an empty one",
    "not_a_look": "{path}: is not the document of an estimate; give its folder, its JSON or a LUT",
    "output_exists": "{path}: exists already; choose another folder or ask to overwrite it",
    "role_absent": "{path}: has no role {role}; use another config",
}

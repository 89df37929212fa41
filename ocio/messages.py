"""Every sentence that the errors of `ocio` say, each once, by its code; see `crfnet_core.messages` for the rules."""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # movies
    "dolby_vision": "{path}: is Dolby Vision of profile {profile}, whose samples only its own decoder shows; give a"
    " version in SDR",
    "frame_undecodable": "{path}: frame {frame} cannot be decoded; copy the movie again, or extract its frames: {line}",
    "movie_changes": "{path}: frame {frame} is {form}, the first {first}; cut the movie where it changes",
    "movie_interlaced": "{path}: is interlaced, each frame mixes two moments; deinterlace it and linearize the frames:"
    " {line} (leave out its filter if both fields show the same moment)",
    "movie_too_large": "{path}: its frames have more than {megapixels} megapixels; scale it, or extract them: {line}",
    "movie_undecodable": "{path}: cannot be decoded ({reason}); copy it again, or extract its frames: {line}",
    "no_video": "{path}: holds no video that FFmpeg decodes; give a movie with a picture",
    "pyav_missing": "{path}: is a movie, which needs PyAV: pip install 'crfnet[video]', or extract its frames: {line}",
    # plates
    "bad_frames": "frames {frames!r}: are not a frame or range; give, say, 1001-1100, 1-9x2 or 1,5,9",
    "bad_workers": "{workers} workers cannot work; give 1 or more",
    "cannot_list": "{folder}: cannot be listed ({problem}); check the folder",
    "exceeds_half": "values up to {peak:.6g} do not fit into half floats; ask for float, or for less exposure",
    "exposure_out_of_range": "an exposure of {stops:g} stops is out of range; give one like -2 or 1.5",
    "exr_channels": "{path}: needs channels R, G and B, or a gray one, of half or float samples; found {channels}",
    "exr_codes": "{path}: most values lie above {most}, but encoded brightness lies in [0, 1]: divide code values by"
    " the largest, such as 255",
    "exr_damaged": "{path}: this EXR file is damaged or cut short ({problem}); write it again",
    "exr_not_finite": "{path}: {count} of its pixels hold NaN or infinity, for which no LUT has an entry; replace them",
    "exr_samples": "{path}: claims {width} x {height} pixels of {channels} channels; crop it, or keep R, G, B and A",
    "exr_unreadable": "{path}: cannot be read ({problem}); check the file",
    "exr_untagged": "{path}: does not say whether its values are linear, as in most OpenEXR files; state it if they are"
    " encoded, as a camera or a program wrote them for a display",
    "finished_differs": "{path}: is there already, with {difference}; use the same options, or another folder",
    "finished_foreign": "{path}: is there already, and is not a whole linear plate of an earlier run; write elsewhere",
    "folder_without_sequence": "{path}: is a folder without a sequence; give a file in it, or a sequence such as"
    " plate.%04d.png or plate.####.png",
    "frames_failed": "{count} of {total} frames failed ({frames}) and the others are written{gaps}; the first: {first}",
    "frames_far_apart": "{path}: frames {first} to {last} are too far apart; say which frames to use",
    "no_placeholder": "{path}: is one name for {count} frames; give a name with a placeholder, such as plate.%04d.exr",
    "no_such_frames": "{path}: frames that exist: {frames}; check the name and the frames",
    "no_such_plate": "{path}: does not exist; check the name, or give a sequence such as plate.%04d.png or"
    " plate.####.png",
    "not_exr": "{path}: linear plates are OpenEXR; give a name that ends in .exr",
    "plate_is_linear": "{path}: is scene-linear already ({space}); give the encoded plate",
    "primaries_differ": "{path}: its primaries are {primaries}, but {expected} in {first}; process them separately, or"
    " state the primaries of all",
    "primaries_unknown": "the primaries are {primaries}, so {space} cannot be reached; state the primaries",
    "several_placeholders": "{path}: holds {count} frame placeholders; leave one of them",
    "several_sequences": "{path}: holds {count} sequences: {patterns}; give one of them",
    "single_file": "{path}: is a single file, which has no frames to choose from; give a pattern",
    "target_is_plate": "{path}: is one of the plates, which are never replaced; choose another name",
    "too_many_frames": "frames {frames!r}: more than {most} frames; give fewer",
    "unknown_depth": "depth {depth!r} is unknown; choose half or float",
    "unknown_output_space": "output space {space!r} is unknown; choose one of {spaces}",
    "unknown_primaries": "primaries {primaries!r} are unknown; choose one of {choices}",
    # exr
    "exr_not_written": "{path}: cannot be written ({reason}); check the disk",
    # luts
    "gray_is_black": "a brightness of {gray:g} is black in this response; pick a brighter gray",
    "lut_black_or_white": "the LUT makes {black:g} of black and {white:g} of white; a response needs 0 and more than 0",
    "lut_brightens": "the LUT brightens, so it leads from light to code values; give its inverse",
    "lut_channels_differ": "the LUT treats R, G and B apart; give one that treats the channels alike",
    "lut_codes": "found code values up to {largest:g}, but the LUT ends at {last:g}: divide them by the largest code,"
    " such as 255",
    "lut_domain": "a LUT needs a finite domain from low to high, found {low:.9g} to {high:.9g}",
    "lut_domain_short": "the LUT is defined from {low:g} to {high:g}; the inverse of a response needs 0 to 1",
    "lut_entry": "entry {entry} of the LUT, {value:.9g}, is not finite or not above the one before",
    "lut_invalid": "{path}: {problem}",
    "lut_length": "a LUT has 2 to {most} entries, found a length of {length}; {usual} suits most",
    "lut_of_codes": "{path}: the LUT takes code values up to {last:g}; write it for brightness from 0 to 1",
    "lut_of_no_numbers": "a LUT needs numbers, found {kind}",
    "lut_not_1d": "{path}: holds {steps}; give a 1D LUT of the camera's response, which treats all channels alike",
    "lut_not_increasing": "{path}: entry {entry} is not above the one before; a LUT that can be inverted increases, and"
    " its decimals have points",
    "lut_refused": "{path}: OpenColorIO reads no LUT from it ({reason}); write the LUT again",
    "lut_shape": "a LUT needs a row of 2 to {most} values, found shape {shape}",
    "lut_span": "the LUT spans more than {most:g}, too much to compute with in single precision",
    "lut_suffix": "{path}: LUT files end in {suffixes}; rename it",
    "lut_tables_differ": "a LUT of R, G and B needs three tables of one length and one domain",
    "lut_unreadable": "{path}: cannot be read ({reason}); check the name of the LUT",
    # configs
    "base_folder_is_variable": "{path}: OpenColorIO takes $ and % for variables; move the config that you build on",
    "base_would_change": "{path}: is the folder of the config that you build on, which stays as it is; choose another",
    "color_space_absent": "{name}: the config has no such color space; add it before writing",
    "color_space_exists": "{name}: the config uses this name for {taken!r}; choose another name",
    "color_space_refused": "{name}: cannot be added to the config ({reason})",
    "config_aliases": "{path}: has more than {most} YAML aliases, each of which may multiply it; write them out",
    "config_archive": "{path}: is an archive; unpack it with OpenColorIO's ocioarchive and name the config in it",
    "config_differs_from_lut": "{name}: its conversion differs from its LUT by {difference:.2g}; write both again",
    "config_invalid": "{path}: not written, OpenColorIO refuses it ({reason})",
    "config_not_built_in": "{name}: is not built into this OpenColorIO; known are {known}",
    "config_reads_device": "{path}: names {file} as a LUT, which is not a file; choose another config",
    "config_refused": "{path}: OpenColorIO refuses this config ({reason}); mend it or choose another",
    "config_unknown": "{name}: is not a config, a built-in config's name or a Blender with one; built in are {known}",
    "config_unreadable": "{path}: cannot be read ({reason}); choose another config",
    "config_variable_unset": "{name}: the environment variable {variable} is not set; name a config",
    "config_variables": "{path}: declares more than {most} variables, or some that multiply one another; write their"
    " values out",
    "config_without_rec709": (
        "the config has neither a space 'lin_rec709_scene' nor a role aces_interchange; add one of them"
    ),
    "exposure_not_finite": "{name}: the exposure is {exposure}; give at most {most} stops up or down",
    "folder_without_look": "{path}: holds no estimate; give the folder, the JSON or a LUT of one",
    "lut_name_is_variable": "{name}: OpenColorIO takes $ and % in {lut_file!r} for variables; rename it",
    "lut_outside_config_folder": "{name}: {lut_file!r} is not a name within the config's folder; put the LUT there",
    "lut_without_inverse_response": "{path}: {reason}",
    "nameless_color_space": "a color space needs a name, found an empty one",
    "not_a_look": "{path}: is not the document of an estimate; give its folder, its JSON or a LUT",
    "role_absent": "{path}: has no role {role}; use another config",
    # pipeline: which files there are, and whether they may be written
    "empty_folder": "{path}: the folder holds no photograph ({suffixes}) outside the output folder; check the name",
    "file_exists": "{path}: exists already; choose another folder",
    "files_exist": "{path}: {name} and {more} more exist already; choose another folder",
    "folder_for_photograph": "{path}: is a folder; give one photograph, or the frames of a shot ({pattern})",
    "folder_in_place": "{path}: is a folder, and a file of that name is to be written; choose another folder",
    "folder_not_written": "{path}: cannot be written to ({reason}); choose another folder",
    "no_response_in_file": "{path}: holds no response; give the JSON of an estimate or of a calibration, or a LUT",
    "no_such_file": "{path}: does not exist; check the name",
    "not_a_file_name": "{name} cannot be the name of a file; give one without slashes, such as eos20d",
    "not_a_folder": "{path}: is not a folder; choose another for the output",
    "not_opened": "{path}: cannot be opened ({reason}); check its name",
    "not_writable": "{path}: is not writable; choose another folder for the output",
    "one_name": "{first} and {second} would both be written as {name}; rename one",
    "replaces_photograph": "{path}: is one of the photographs and would be replaced; choose another folder",
    "variables_in_path": "{path}: OpenColorIO takes $ and % in it for variables and finds no LUT; choose another"
    " folder",
    # pipeline: many photographs
    "movie_in_batch": "{path}: is a movie; linearize it by itself",
    "no_dask": "a scheduler needs Dask: pip install 'crfnet[cluster]'",
    "no_memory": "{path}: not enough memory",
    "no_scheduler": "{address}: no Dask scheduler answers there ({reason}); check the address",
    "not_records": "{path}: holds other lines than records of photographs; choose another folder",
    "other_options": "{path}: has {photo} with other options or another response; give the same, or choose another"
    " folder",
    "photographs_failed": "{failed} of {count} photographs failed; the first: {problem}",
    "process_died": "a process died, perhaps for lack of memory; run the same again",
    "reader_failed": "{path}: {kind} ({reason})",
    "unreadable": "{path}: {reason}",
}

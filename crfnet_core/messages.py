"""Every sentence that the errors and notices of `crfnet_core` say, each once, by its code.

A sentence says what was found, what was needed and what to do, on one line, in the terms of the library: it names no
option of the command and no button of Blender. Names in braces are the facts of the case.
"""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # library
    "bad_camera_name": "{name!r} cannot name a camera; it takes 1 to 60 letters, digits, spaces and signs of '.,+()-_,"
    " a letter or a digit first",
    "camera_exists": "{folder} has a camera {name!r} already",
    "camera_folder": "{folder}: cannot be made ({reason}); set {variable} to another folder",
    "camera_not_measured": "{path}: holds no measured response; measure the camera, or remove the file",
    "camera_not_removed": "{path}: cannot be removed ({reason})",
    "camera_version": "{path}: has camera_version {version}, needed is {needed}; update this program",
    "damaged_calibration": "{path}: is damaged ({reason}); calibrate again",
    "damaged_camera": "{path}: is damaged ({reason}); restore or remove it",
    "no_camera": "there is no camera {name!r} in {folder}",
    "not_a_calibration": "{path}: is not the JSON file of a calibration; calibrate the camera first",
    "not_a_camera": "{path}: is not the JSON file of a camera; restore or remove it",
    "other_camera": "the photograph is of {other}, but {name!r} is {camera}",
    "unreadable_camera": "{path}: cannot be read ({reason}); check its name",
    # network
    "altered_model": "{folder}: model.onnx is not the file that model.json describes; restore the pair",
    "bad_model_config": "{path}: lacks {entries}, or holds something else there; export the model again",
    "bad_model_json": "{path}: is not JSON with an object; restore it",
    "bad_output": "{folder}: model.onnx answers with {name} of shape {shape} or not finite, needed is {needed}; export"
    " the model again",
    "bad_signature": "{folder}: model.onnx needs one input, and {name} of float {needed}; export the model again",
    "external_weights": "{folder}: model.onnx has weights in another file; export the model again",
    "failing_graph": "{folder}: model.onnx fails ({reason}); export the model again",
    "negative_threads": "the number of threads must be 0 (all cores) or more, found {threads}",
    "other_kind_of_model": "{path}: is for {found} (basis, weights, window size), needed is {needed}, with evidence of"
    " windows or statistics; export the model again",
    "other_model_here": "{path}: holds another model than the process that sent it; install the same version",
    "unloadable_graph": "{folder}: onnxruntime cannot load model.onnx; restore it or update ({reason})",
    "unreadable_model": "{path}: cannot be read ({reason}); a model is a folder with model.json and model.onnx",
    # posterior
    "bad_lookalikes": "{path}: lookalikes is a share of all photographs, below 1",
    "bad_prior": '{path}: needed is {{"shares": {{"phone": 0.5, "camera": 0.5}}, "evidence": 0.15}}',
    "bad_prior_families": "{path}: shares are of {families}",
    "bad_prior_values": "{path}: its values are numbers from 0 to 1, and one share is above 0",
    "no_prior": "{name}: there is no prior ({reason}); give {names} or a JSON file",
    "prior_not_json": "{path}: is not JSON; see crfnet_core/data/priors for examples",
    # HEIC, AVIF and JPEG XL
    "deep_avif_coding": "{path}: AVIF of {samples} samples and matrix {matrix} is not read; save it as 16-bit PNG",
    "deep_avif_package_missing": "{path}: AVIF of {bits} bits needs PyAV: pip install av, or save it as 16-bit PNG",
    "deep_avif_tiles": "{path}: AVIF of {bits} bits in tiles is not read; save it as 16-bit PNG",
    "heif_package_missing": "{path}: {kind} needs the package {package}; pip install pi-heif pillow",
    "jxl_linear": "{path}: this JPEG XL file is decoded to linear light, as lossy ones with a camera's ICC profile are;"
    " give the original that it was made from",
    # statistics
    "negative_seed": "a seed of {seed} draws no windows; give 0 or more",
    "no_windows_asked": "{count} windows cannot be analyzed; ask for at least 1, usually {usual}",
    "smaller_than_window": "the photograph is {width} x {height} pixels; at least {least} x {least} are needed: give"
    " the original, never one scaled up",
    "step_too_large": "a step of {step} pixels does not fit into {width} x {height} pixels; take 1 to {most}",
    # files
    "exists": "{path}: exists already; choose another name or ask to overwrite it",
    "folder_absent": "{path}: the folder {folder} does not exist; create it first",
    "folder_read_only": "{path}: the folder {folder} is not writable; choose another",
    "is_folder": "{path}: is a folder; give the name of a file",
    "not_written": "{path}: cannot be written ({reason})",
    # response
    "brightness_codes": "found values up to {found:g}, but brightness and irradiance lie in [0, 1]: divide code values"
    " by the largest code, such as 255",
    "curve_dark": "a response must be brighter at full irradiance than in the dark",
    "curve_exponent": "a gamma must be above 0, found {exponent}",
    "curve_not_strict": "a response must increase strictly from 0 to 1; use from_samples",
    "curve_samples": "a response needs a row of two or more finite samples",
    "curve_shape": "a response needs shape ({samples},), found {shape}; use from_samples",
}

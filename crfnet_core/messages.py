"""Every sentence that the errors and notices of `crfnet_core` say, each once, by its code.

A sentence says what was found, what was needed and what to do, on one line, in the terms of the library: it names no
option of the command and no button of Blender. Names in braces are the facts of the case.
"""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # library
    "bad_camera_name": "{name!r} cannot name a camera; it takes 1 to 60 letters, digits, spaces and signs of '.,+()-_,"
    " a letter or a digit first and no dot last, and no device of Windows, such as CON",
    "camera_exists": "{folder} has a camera {name!r} already",
    "camera_folder": "{folder}: cannot be used ({reason}); set {variable} to another folder",
    "camera_not_measured": "{path}: holds no measured response; measure the camera, or remove the file",
    "camera_not_removed": "{path}: cannot be removed ({reason})",
    "camera_version": "{path}: has camera_version {version}, needed is {needed}; update this program",
    "damaged_calibration": "{path}: is damaged ({reason}); calibrate again",
    "damaged_camera": "{path}: is damaged ({reason}); restore or remove it",
    "no_camera": "there is no camera {name!r} in {folders}",
    "not_a_calibration": "{path}: is not the JSON file of a calibration; calibrate the camera first",
    "not_a_camera": "{path}: is not the JSON file of a camera; restore or remove it",
    "other_camera": "the photograph is of {other}, but {name!r} is {camera}",
    "unreadable_camera": "{path}: cannot be read ({reason}); check its name",
    # network
    "altered_model": "{folder}: model.onnx is not the file that model.json describes; restore the pair",
    "bad_model_config": "{path}: is damaged ({problem}); export the model again",
    "bad_model_json": "{path}: is not JSON with an object; restore it",
    "bad_output": "{folder}: model.onnx answers with {name} of shape {shape} or not finite, needed is {needed}; export"
    " the model again",
    "external_weights": "{folder}: model.onnx has weights in another file, or sparse ones; export the model again",
    "failing_graph": "{folder}: model.onnx fails ({reason}); export the model again",
    "negative_threads": "the number of threads must be 0 (all cores) or a whole number above, found {threads}",
    "other_kind_of_model": "{path}: is for {found} (basis, weights, window size), needed is {needed}, with evidence of"
    " windows or statistics; export the model again",
    "unloadable_graph": "{folder}: model.onnx cannot be loaded; restore it or update ({reason})",
    "unreadable_model": "{path}: cannot be read ({reason}); a model is a folder with model.json and model.onnx",
    # posterior
    "bad_lookalikes": "{path}: lookalikes is a share of all photographs, below 1",
    "bad_prior": '{path}: needed is {{"shares": {{"phone": 0.5, "camera": 0.5}}, "evidence": 0.15}}',
    "bad_prior_families": "{path}: shares are of {families}",
    "bad_prior_values": "{path}: its values are numbers from 0 to 1, and one share is above 0",
    "no_prior": "{name}: there is no prior ({reason}); give {names} or a JSON file",
    "prior_not_json": "{path}: is not JSON; see crfnet_core/data/priors for examples",
    # HEIC, AVIF and JPEG XL
    "deep_avif_package_missing": "{path}: needs PyAV, as AVIF beyond 8 bits in full range does: pip install av",
    "heif_package_missing": "{path}: {kind} needs the package {package}; pip install pi-heif pillow",
    "jxl_linear": "{path}: this JPEG XL file is decoded to linear light, as lossy ones with a camera's ICC profile are;"
    " give the original that it was made from",
    # statistics
    "smaller_than_window": "{path}: the photograph is {width} x {height} pixels; at least {least} x {least} are needed:"
    " give the original, never one scaled up",
    # files
    "exists": "{path}: exists already; choose another name or ask to overwrite it",
    "folder_absent": "{path}: the folder {folder} does not exist; create it first",
    "folder_read_only": "{path}: the folder {folder} is not writable; choose another",
    "is_folder": "{path}: is a folder; give the name of a file",
    "name_reserved": "{path}: names that begin with {prefix} are those of temporary files; choose another",
    "not_written": "{path}: cannot be written ({reason})",
    "written_meanwhile": "{path}: was written by another process meanwhile; choose another name",
    # response
    "curve_rows": "needed are finite numbers in rows of {length}, found shape {shape}",
    "not_numbers": "a response or a LUT needs numbers, found {kind}",
    "brightness_codes": "found values up to {found:.9g}, not brightness: divide codes by the largest one, say 255",
    "curve_dark": "a response must be brighter at full irradiance than in the dark",
    "curve_exponent": "a gamma must be a number above 0, found {exponent}",
    "curve_not_strict": "a response must increase strictly from 0 to 1; use from_samples",
    "curve_samples": "a response needs a row of two or more finite samples",
    "curve_shape": "a response needs shape ({samples},), found {shape}; use from_samples",
    # photograph: arrays
    "array_above_bit_depth": "{path}: holds code {code}, but bit_depth={bit_depth} ends at {largest}; give its own"
    " bit_depth",
    "array_bit_depth": "{path}: {kind} cannot hold a photograph of bit_depth={bit_depth}; give a whole number from"
    " 8 to {most}",
    "array_channels_first": "{path}: has shape {shape}; needs (H, W), or (H, W, C) with 1 to 4 channels: where channels"
    " come first, give array.transpose(1, 2, 0)",
    "array_holds_nan": "{path}: holds NaN; replace it, or leave these rows and columns out",
    "array_is_none": "{path}: is None, which OpenCV's imread returns for a file it cannot read; check its name",
    "array_other_order": "{path}: has {channels} channels, but color_order='{order}'; give the order of all channels",
    "array_out_of_range": "{path}: holds values from {low:.17g} to {high:.17g}; encoded brightness lies in [0, 1]:"
    " divide code values by the largest (255 for 8 bits), or clip overshoot; a scene-linear picture holds no camera"
    " response",
    "array_sample_type": "{path}: holds {kind}; give uint8, uint16 with its bit_depth, or floating point in [0, 1]"
    " (array.astype converts); read_photo reads files",
    "array_shape": "{path}: has shape {shape}; needs (H, W), or (H, W, C) with 1 to 4 channels",
    "array_unknown_order": "{path}: color_order is {order}; give one of {orders}",
    "array_without_bit_depth": "{path}: uint16 may hold 10, 12 or 16 bits; give bit_depth=16 if white is 65535",
    "array_without_order": "{path}: has {channels} channels and no color_order; give color_order='RGB', 'BGR' (OpenCV's"
    " order), 'RGBA', 'BGRA' or 'LA'",
    "photo_pixels": "{path}: the pixels are {kind}, shape {shape}; a Photo holds float32 of shape (H, W, 3):"
    " Photo.from_array converts",
    "pillow_closed": "{path}: the Pillow image is closed; give it open, or its array",
    "pillow_mode": "{path}: is a Pillow image of mode '{mode}', which is not taken; give the RGB photograph that it was"
    " made from, or its codes of 8 or 16 bits as an array",
    "pillow_order_stated": "{path}: is a Pillow image of mode '{mode}', so leave color_order='{order}' out",
    # photograph: files
    "camera_raw": "{path}: camera raw holds no encoded picture; give the JPEG, HEIC or TIFF developed from it, or the"
    " one that the camera wrote with it",
    "cannot_open_photograph": "{path}: cannot be opened ({problem}); check its name and permissions",
    "coding_not_read": "{path}: this {kind} file has a coding that is not read ({problem}); save it with another",
    "damaged": "{path}: this {kind} file is damaged or cut short ({problem}); copy it again",
    "name_not_utf8": "{path}: the name is not UTF-8; rename the file or its folder",
    "no_such_photograph": "{path}: does not exist; check the name",
    "not_a_file": "{path}: is a pipe or a device; give a file",
    "not_an_image_file": "{path}: does not begin as a JPEG, HEIC, PNG, TIFF, WebP, AVIF, JPEG XL, JPEG 2000, DPX or BMP"
    " file; save the photograph as one of these, and give an open file at its beginning",
    "other_colors": "{path}: holds {kind}, which hides the camera's response; give the RGB photograph it came from",
    "palette": "{path}: {kind} holds at most 256 colors, mostly mixed by dither, from which no response can be"
    " estimated; give the photograph that it was made from",
    "photograph_is_empty": "{path}: the file is empty; copy it again",
    "photograph_is_folder": "{path}: is a folder; give a photograph in it",
    "photograph_source": "a {kind} is not a path, bytes or a binary file; give one of these, as open(path, 'rb')",
    "raw_not_read": "{path}: LibRaw cannot read this {suffix} file ({problem}); convert it to DNG, or copy it again",
    "rawpy_missing": "{path}: camera raw is read by rawpy, and measured with SciPy: pip install 'crfnet[calibrate]'",
    "sample_type": "{path}: holds {bits}-bit {kind} samples; needs 8 to 16 bits, unsigned: convert it",
    "scene_linear_file": "{path}: no response is estimated from {kind}, whose values are scene-linear as a rule; give"
    " the JPEG, HEIC or TIFF that the camera or the raw developer wrote",
    "stream_at_end": "{path}: nothing is left to read from where the file stands; seek to its beginning",
    "stream_not_read": "{path}: reading the open file failed ({kind}: {problem}); open it again, or get it again",
    "too_many_pixels": "{path}: claims {width} x {height} pixels; at most {megapixels} megapixels are read: crop it",
    "volume": "{path}: holds a volume; give a flat photograph",
    # photograph: recognition
    "few_levels": "few levels: the codes pile up at some levels, with little between them, as in drawn and posterized"
    " pictures",
    "few_levels_advice": "give a photograph with all its levels",
    "mostly_ends": "more than half of all samples are exactly black or white, as in mattes, and no camera is named",
    "flat_frame": "a flat frame: its brightness lies between codes {low} and {high} of 255, so too little of the"
    " response shows",
    "flat_frame_advice": "give a photograph with dark and bright parts, whose white is the largest code",
    "merged": "written by {editor}, which merges exposures: its tones differ from place to place",
    "merged_advice": "give one of the exposures as the camera wrote it, or the merged light as a linear EXR",
    "noise_frame": "noise or a texture: near parts of the frame are no more alike than far ones, so no scene shows",
    "noise_frame_advice": "give a photograph of a scene, or the file as the camera wrote it",
    "limited_range": "probably limited range stored as full: hardly a code lies beyond 16 and 235 of 255, which are"
    " black and white of video",
    "limited_range_advice": "if so, expand the range first: when ffmpeg extracts frames, with its filter"
    " scale=in_range=limited:out_range=full",
    "log_footage": "log footage, or haze: black lies at code {code} of 255; by its levels the curve may be {curves}",
    "log_footage_advice": "give it the color space of the log curve that the camera was set to, which its menu or the"
    " clip's metadata say",
    "log_footage_of_maker": "log footage, or haze: black lies at code {code} of 255; its maker's curve is {curve}",
    "log_footage_safest": "if nothing says, {curve} is safest: its light may be off by {stops} stop",
    "log_footage_spaces": "give it the color space of the log curve that the camera was set to, which its menu or the"
    " clip's metadata say, in ACES configs {spaces}",
    "rendering": "a rendering by {renderer}, as its metadata says: no camera made it",
    "rendering_advice": "render a linear EXR, or undo the view transform with the renderer's OpenColorIO config",
    "sent_copy": "a copy as messengers and web sites send it: no camera named, scaled, and compressed as JPEG of"
    " quality {quality}; both change what the estimate reads",
    "sent_copy_advice": "ask for the file that the camera wrote",
    "tagged_color_space": "{path}: is encoded as {transfer}: so says its metadata ({source}). That curve is published,"
    ' so give the plate its color space, in ACES configs "{space}", and no estimate; if the tag is wrong, ignore'
    " metadata",
    "tagged_encoding": "{path}: is encoded as {transfer}: so says its metadata ({source}). No camera's response shows,"
    " so give the plate its color space, and no estimate; if the tag is wrong, ignore metadata",
    "tagged_linear": "{path}: is linear already: so says its metadata ({source}). Give it a linear color space; if the"
    " tag is wrong, ignore metadata",
    "thermal": "a picture by {camera}, a thermal camera: mostly colors that stand for temperatures",
    "thermal_advice": "give a photograph of light; if this is one, state what took it",
    # estimate: errors
    "argument_kind": "{name} is a {found}; give a {needed}",
    "bad_option": "the option {name}: {problem}",
    "damaged_estimate": "the document of an estimate is damaged ({problem})",
    "estimate_lacks": "the document of an estimate lacks {entry}; write it again",
    "list_of_estimates": "this document holds a list of estimates; give document['estimates'][0]",
    "no_photographs": "there is no photograph to analyze; give at least one",
    "not_a_photo": "a {kind} is not a Photo; read_photo makes one from a file, Photo.from_array from an array",
    "not_an_estimate": "this is not a document of an estimate: it lacks 'schema_version'",
    "other_schema": "the estimate has schema_version {found}, this version reads {known}: update it",
    # estimate: warnings; where JSON has them, their text does not change
    "answer_of_windows": "the mean of the windows' answers, as in the CRF-net paper: on photographs of real cameras it"
    " is worse (E_est 2.52, 0.235 stop) than the mean of other cameras (1.27, 0.102), so another model is the default",
    "as_written": "{text}",
    "clipped": "mostly clipped: the answer is little more than the mean of cameras, so take one with another exposure",
    "developed": "written by {editor}, as a rule from a raw file, and not by the camera: give the camera's own file;"
    " linear light, which such programs write, too, needs no estimate",
    "edited": "saved by {editor}, which may have changed the tones: give the camera's own file",
    "gray": "gray or toned: one channel says less than three, and it may be a mixture of channels",
    "narrow_range": "no window covers the range of brightness: expect a poor estimate",
    "recognized": "{reason}",
    "scan": "a scan of film or paper: the prior for any source expects its tones, that for cameras does not",
    "several_cameras": "photographs of different cameras ({cameras}): estimate each camera by itself",
    # calibration
    "bad_seconds": "'{text}' is not an exposure time; give seconds such as 1/60 or 0.5",
    "blocks_left_out": "{part:.0%} of the blocks do not fit and were left out: something moved",
    "dark_unseen": "no code below {low:.0f} is seen: there the curve is like known responses",
    "codes_above_unseen": "no code above {highest:.0f} is seen: there the curve is that of known responses",
    "codes_unseen": "flat parts of the pictures show {part:.0%} of the codes between {first} and {last}; take a scene"
    " with more range, or frames closer together",
    "dark_channel": "only {count} flat places are seen well in two frames, {least} are needed: in {channels} nearly"
    " everything is black or white; use white light and a scene of neutral colors",
    "exposures_gap": "neighboring exposures are {step} stops apart; check the times, or take frames 1 or 2 stops apart",
    "exposures_span": "the exposures span {span} stops; a stack needs {least:g} or more, from nearly nothing white to"
    " nearly everything white",
    "few_cells": "{path}: only {count} flat places are neither clipped nor saturated, {least} are needed; take a scene"
    " with even surfaces, dark and bright",
    "few_flat_places": "only {count} flat places are seen well in two frames, {least} are needed; take more frames,"
    " closer together, or a scene with even surfaces",
    "few_frames": "a stack needs at least {least} frames of one scene at different exposures, found {count}; take more,"
    " a stop apart",
    "frame_bits": "{path}: has other bits per sample than {first}; give files of one kind",
    "frame_camera": "{path}: names {camera}, {first} {first_camera}; give frames of one camera",
    "frame_edited": "{path}: saved by {editor}, which may have changed the tones; give the camera's own files",
    "frame_mistimed": "{path}: is {stops:.2f} stop {direction} than its exposure time says, relative to the other"
    " frames; correct its time, or leave the frame out",
    "frame_off": "{name} is {off:+.2f} stop from its exposure label",
    "frame_size": "{path}: has {size} pixels, {first} has {first_size}; give the frames of one stack, all as the camera"
    " wrote them",
    "frame_twice": "{path}: is the same picture as {first}; give each frame once",
    "frame_unfit": "{name} does not fit the other frames and was left out",
    "frames_differ": "the frames follow different curves, {codes:.1f} codes apart: each was rendered on its own, or in"
    " another picture style",
    "frame_untimed": "{path}: names no exposure time; give the times of all frames",
    "jpeg_too_small": "{path}: the JPEG has fewer than {least} pixels along its longer side; give the camera's JPEG of"
    " full size",
    "jpeg_without_raw": "{path}: there is no raw file of this name; give each JPEG with its raw file",
    "local_fitted": "the camera brightened places by their surroundings (local tone mapping, exponent {local:+.2f});"
    " the curve is without that, and plates keep it",
    "local_tones": "{path}: the camera brightened places by their surroundings (local tone mapping, exponent"
    " {local:+.2f}), so there is not one curve; switch off automatic tones (D-Lighting, DRO, HDR) and shoot again",
    "measures_program": "the JPEG was made by {editor}: this is the response of that program, and not of the camera",
    "no_raw_file": "{path}: there is no raw file here; give raw files with their JPEGs, or a stack of 4 or more frames",
    "no_single_curve": "no single curve explains the frames: they are off by {residual} codes (RMS), at most {most:g}"
    " are usual; each was rendered or edited on its own (automatic tones, local tone mapping, HDR): switch that off,"
    " and give the camera's own files",
    "pair_cropped": "{path}: shows another part of the scene than {raw} does; give the JPEG as the camera wrote it with"
    " this raw file, not cropped",
    "pair_dark": "{path}: no code above {top:.0f} is seen, {least:.0f} is needed; take a brighter exposure",
    "pair_differs": "{path}: does not show the same as {raw} (correlation {correlation:.2f}); give the JPEG of the same"
    " shot, as the camera wrote it",
    "pair_exposed": "{path}: was exposed for {seconds:.3g} s, {raw} for {raw_seconds:.3g} s; give the JPEG of the same"
    " shot",
    "pair_tilted": "{path}: is brightened by {stops:.1f} stops from one side to the other, as by a gradient filter;"
    " give the JPEG as the camera wrote it",
    "pair_unexplained": "{path}: no single curve and color matrix explain the JPEG ({residual:.1f} codes off,"
    " {outliers:.0%} of the cells left out); give one that the camera wrote, without effects",
    "raw_without_jpeg": "{path}: holds no JPEG and none of its name is beside it; give it with its JPEG",
    "rest_span": "without the frames that do not fit the others ({unfit} of {count}), the exposures span {span} stops;"
    " these need {least:g} or more: use a tripod and a still scene, and take frames one or two stops apart",
    "scene_moved": "the frames do not show the same scene: {which} differ from the others even after alignment; the"
    " camera or the scene has moved, so use a tripod and a still scene, or leave these frames out",
    "settings_differ": "{settings} differ between the frames: exposures are time x ISO / f-number^2",
    "shots_differ": "{first} and {last} are rendered {stops:.2f} stop apart, at most {most:g}; give shots of one"
    " picture style, without automatic tones",
    "times_count": "{times} times are given for {frames} frames; give one for each, in order",
    "times_differ": "the given times are up to {stops:.1f} stops from the files' own, relative to each other",
    "unknown_curve": "the curve that explains the frames is far from every known response (E_est {distance}, at most"
    " {most:g}); the exposure times are probably wrong, so check them, or the files were edited",
    "unlike_cameras": "unlike every camera's own rendering that is known (E_est {distance:.1f}): check the times",
    "white_below_largest": "white is {code:.0f} of 255 codes: the codes above it are white too",
    "white_bracketed": "the brightest codes are not seen: where white is, is known only to lie between them and"
    " saturation of the sensor; take a brighter scene too",
    "white_extrapolated": "where white is was extrapolated from the codes below it",
    "white_unseen": "no frame reaches white: the scale is a guess; add a longer exposure",
}

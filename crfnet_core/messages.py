"""Every sentence that the errors and notices of `crfnet_core` say, each once, by its code.

A sentence says what was found, what was needed and what to do, on one line, in the terms of the library: it names no
option of the command and no button of Blender. Names in braces are the facts of the case.
"""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # photograph: arrays
    "array_above_bit_depth": "{path}: holds code {code}, but bit_depth={bit_depth} ends at {largest}; give its own"
    " bit_depth",
    "array_bit_depth": "{path}: {kind} cannot hold a photograph of bit_depth={bit_depth}; give 8 to {most}",
    "array_channels_first": "{path}: has shape {shape}; needs (H, W), or (H, W, C) with 1 to 4 channels: where channels"
    " come first, give array.transpose(1, 2, 0)",
    "array_holds_nan": "{path}: holds NaN; replace it, or leave these rows and columns out",
    "array_is_file_name": "{path}: '{file}' is the name of a file; read_photo reads files",
    "array_is_none": "{path}: is None, which OpenCV's imread returns for a file it cannot read; check its name",
    "array_other_order": "{path}: has {channels} channels, but color_order='{order}'; give the order of all channels",
    "array_out_of_range": "{path}: holds values from {low:g} to {high:g}; encoded brightness lies in [0, 1]: divide"
    " code values by the largest (255 for 8 bits), or clip overshoot; a scene-linear picture holds no camera response",
    "array_sample_type": "{path}: holds {kind}; give uint8, uint16 with its bit_depth, or floating point in [0, 1]"
    " (array.astype converts)",
    "array_shape": "{path}: has shape {shape}; needs (H, W), or (H, W, C) with 1 to 4 channels",
    "array_unknown_order": "{path}: color_order is {order}; give one of {orders}",
    "array_unusable": "{path}: NumPy makes no array of this {kind} ({problem})",
    "array_without_bit_depth": "{path}: uint16 may hold 10, 12 or 16 bits; give bit_depth=16 if white is 65535",
    "array_without_order": "{path}: has {channels} channels and no color_order; give color_order='RGB', 'BGR' (OpenCV's"
    " order), 'RGBA', 'BGRA' or 'LA'",
    "photo_pixels": "{path}: the pixels are {kind}, shape {shape}; a Photo holds float32 of shape (H, W, 3):"
    " Photo.from_array converts",
    "pillow_mode_associated": "{path}: is a Pillow image of mode '{mode}', associated alpha; give"
    " image.convert('RGBA')",
    "pillow_mode_of_numbers": "{path}: is a Pillow image of mode '{mode}', numbers of 32 bits; give"
    " numpy.asarray(image), as uint16 with its bit_depth, or scaled to [0, 1]",
    "pillow_mode_of_other_colors": "{path}: is a Pillow image of mode '{mode}', which hides the camera's response; give"
    " the RGB photograph that it was made from",
    "pillow_mode_unknown": "{path}: is a Pillow image of mode '{mode}', which is not taken; give image.convert('RGB')",
    "pillow_order_stated": "{path}: is a Pillow image of mode '{mode}', so leave color_order='{order}' out",
    # photograph: files
    "camera_raw": "{path}: camera raw holds no encoded picture; give the JPEG, HEIC or TIFF developed from it, or the"
    " one that the camera wrote with it",
    "cannot_open_photograph": "{path}: cannot be opened ({problem}); check its name and permissions",
    "coding_not_read": "{path}: this {kind} file has a coding that is not read ({problem}); save it with another",
    "damaged": "{path}: this {kind} file is damaged or cut short ({problem}); copy it again",
    "name_not_utf8": "{path}: the name is not UTF-8; rename the file or its folder",
    "no_such_photograph": "{path}: there is no such file; check the name",
    "not_an_image_file": "{path}: is not a JPEG, HEIC, PNG, TIFF, WebP, AVIF, JPEG XL, JPEG 2000, DPX, BMP or TGA file,"
    " whatever its name says; save the photograph as one of these",
    "null_suffix": "{path}: OpenImageIO reads no file of the suffix {suffix}; rename it",
    "other_colors": "{path}: holds {kind}, which hides the camera's response; give the RGB photograph that it came"
    " from",
    "palette": "{path}: {kind} holds at most 256 colors, mostly mixed by dither, from which no response can be"
    " estimated; give the photograph that it was made from",
    "photograph_is_empty": "{path}: the file is empty; copy it again",
    "photograph_is_folder": "{path}: is a folder; give a photograph in it",
    "photograph_source": "a {kind} is not a path, bytes or a binary file; give one of these",
    "sample_type": "{path}: holds {bits}-bit {kind} samples; needs 8 to 16 bits, unsigned: convert it",
    "scene_linear_file": "{path}: {kind} holds scene-linear values, in which no camera response is left to estimate;"
    " give the JPEG, HEIC or TIFF that the camera or the raw developer wrote",
    "too_many_pixels": "{path}: claims {width} x {height} pixels; at most {megapixels} megapixels are read: crop it",
    "volume": "{path}: holds a volume; give a flat photograph",
    # photograph: recognition
    "flat_frame": "a flat frame: its brightness has no range, so no response shows",
    "flat_frame_advice": "give a photograph with dark and bright parts",
    "limited_range": "limited range stored as full: the codes end at 16 and 235 of 255, which are black and white of"
    " video",
    "limited_range_advice": "expand the range first: when ffmpeg extracts frames, with its filter"
    " scale=in_range=limited:out_range=full",
    "log_footage": "log footage: black lies at code {code} of 255; by its levels the curve may be {curves}",
    "log_footage_advice": "give it the color space of the log curve that the camera was set to, which its menu or the"
    " clip's metadata say",
    "log_footage_of_maker": "log footage: black lies at code {code} of 255; its maker's curve is {curve}",
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
    "tagged_encoding": "{path}: is encoded as {transfer}: so says its metadata ({source}). That curve is published, so"
    " give the plate its color space, and no estimate; if the tag is wrong, ignore metadata",
    "tagged_linear": "{path}: is linear already: so says its metadata ({source}). Give it a linear color space; if the"
    " tag is wrong, ignore metadata",
}

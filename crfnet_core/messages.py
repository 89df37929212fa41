"""Every sentence that the errors and notices of `crfnet_core` say, each once, by its code.

A sentence says what was found, what was needed and what to do, on one line, in the terms of the library: it names no
option of the command and no button of Blender. Names in braces are the facts of the case.
"""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # HEIC, AVIF and JPEG XL
    "deep_avif_coding": "{path}: AVIF of {samples} samples and matrix {matrix} is not read; save it as 16-bit PNG",
    "deep_avif_package_missing": "{path}: AVIF of {bits} bits needs PyAV: pip install av, or save it as 16-bit PNG",
    "deep_avif_tiles": "{path}: AVIF of {bits} bits in tiles is not read; save it as 16-bit PNG",
    "heif_package_missing": "{path}: {kind} needs the package {package}; pip install pi-heif pillow",
    "jxl_linear": "{path}: this JPEG XL file is decoded to linear light, as lossy ones with a camera's ICC profile are;"
    " give the original that it was made from",
}

"""Every sentence that the errors of `ocio` say, each once, by its code; see `crfnet_core.messages` for the rules."""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # exr
    "exr_not_written": "{path}: cannot be written ({reason}); check the disk",
    # luts
    "gray_is_black": "a brightness of {gray:g} is black in this response; anchor a brighter gray",
    "lut_black_or_white": "the LUT makes {black:g} of black and {white:g} of white; a response needs 0 and more than 0",
    "lut_brightens": "the LUT brightens, so it leads from light to code values; give its inverse",
    "lut_channels_differ": "the LUT treats R, G and B apart; give one that treats the channels alike",
    "lut_codes": "found integers up to {found}, but the LUT ends at {last:g}: divide code values by the largest code,"
    " such as 255",
    "lut_domain": "a LUT needs a finite domain from low to high, found {low:.9g} to {high:.9g}",
    "lut_domain_short": "the LUT is defined from {low:g} to {high:g}; the inverse of a response needs 0 to 1",
    "lut_entry": "entry {entry} of the LUT, {value:.9g}, is not finite or not above the one before",
    "lut_invalid": "{path}: {problem}",
    "lut_length": "a LUT has 2 to {most} entries, found a length of {length}; {usual} suits most",
    "lut_not_1d": "{path}: holds {found}; give a 1D LUT of the camera's response, which treats all channels alike",
    "lut_not_increasing": "{path}: entry {entry} is not above the one before; a LUT that can be inverted increases, and"
    " its decimals have points",
    "lut_refused": "{path}: OpenColorIO reads no LUT from it ({reason}); write the LUT again",
    "lut_shape": "a LUT needs a row of 2 to {most} values, found shape {shape}",
    "lut_span": "the LUT spans more than {most:g}, too much to compute with in single precision",
    "lut_suffix": "{path}: LUT files end in {suffixes}; rename it",
    "lut_tables_differ": "a LUT of R, G and B needs three tables of one length and one domain",
    "lut_unreadable": "{path}: cannot be read ({reason}); check the name of the LUT",
}

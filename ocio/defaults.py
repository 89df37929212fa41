"""Constants that several modules share. Nothing is imported here, so that `crfnet --help` loads fast."""

#: File name of the OpenColorIO config next to the LUTs; Blender looks for the same name.
CONFIG_NAME = "config.ocio"

#: File names of the records in the output folder: of `crfnet estimate --each`, and of `crfnet linearize --each`.
ESTIMATES, PLATES = "estimates.jsonl", "plates.jsonl"

#: Entries of a LUT: 255 * 16 + 1, so that every 8-bit code lies on an entry and is converted exactly.
LUT_LENGTH = 4081

#: The packaged priors, as in `crfnet_core.posterior`; the first is the default.
PRIORS = ("camera", "any")

#: Devices that a user may state: kinds of `crfnet_core.photograph.metadata.Device`, or another one.
DEVICES = ("phone", "compact", "camera", "other")

#: Frames of a sequence from which its one response is estimated.
FRAMES_ANALYZED = 8

#: Largest exposure in either direction, in stops: 2 ** 15 times white still fits into a half float.
MAX_EXPOSURE = 15

#: The largest one with an anchor: powers of two that single precision holds.
MOST_STOPS = 100

#: The sample types of linear EXR files; the first is the default.
DEPTHS = ("half", "float")

#: Scene-linear value of a surface that reflects 18 % of the light.
MIDDLE_GRAY = 0.18

#: Encoded brightness at which cameras place such a surface by convention: 461/1000 of the largest value (ISO 12232,
#: standard output sensitivity), which is what sRGB makes of 0.18; code 118 of 8 bits.
GRAY_BRIGHTNESS = 0.4614

#: Names of a plate's primaries: the first, the default, goes by the file's tags; the others are the names in
#: `crfnet_core.colorimetry.PHOTOGRAPHIC`.
PRIMARIES = ("auto", "rec709", "p3", "adobe", "prophoto", "rec2020")

#: The spaces of linear EXR files: linear Rec.709, which is the role scene_linear of the configs that we write (the
#: default); the plate's own primaries; and the spaces of ACES.
OUTPUT_SPACES = ("scene_linear", "plate", "ACEScg", "ACES2065-1")

#: Estimation error (E_est) of gamma 2.2 on 29 camera bodies (P4), and its shape error in stops.
GAMMA_ERROR, GAMMA_SHAPE_ERROR = 3.71, 0.74

#: Error of the place of white, in stops: root mean square over 43 camera bodies (P4, with caution).
WHITE_ERROR = 0.26

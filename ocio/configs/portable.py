"""A config of our own for plates, that every host from OpenColorIO 2.0 on can load."""

from __future__ import annotations

from collections.abc import Sequence

import PyOpenColorIO as OCIO

from crfnet_core.errors import ConfigError
from ocio.configs.plate_color_space import REC709_TO_AP0, PlateColorSpace, add_plate_color_space

#: What a portable config holds besides the plates. The names are Blender's, so that its files find their spaces.
PORTABLE = """\
ocio_profile_version: 2
environment: {}
search_path: "."
strictparsing: true
luma: [0.2126, 0.7152, 0.0722]
name: crfnet
description: Camera responses estimated from photographs; scene-linear is Rec.709 with a D65 white.
roles:
  aces_interchange: ACES2065-1
  cie_xyz_d65_interchange: CIE-XYZ-D65
  color_picking: sRGB
  color_timing: ACEScct
  compositing_log: ACEScct
  data: Non-Color
  default_byte: sRGB
  default_float: Linear Rec.709
  default_sequencer: sRGB
  matte_paint: sRGB
  reference: Linear Rec.709
  rendering: Linear Rec.709
  scene_linear: Linear Rec.709
  texture_paint: sRGB
file_rules:
  - !<Rule> {name: Scene-linear files, colorspace: scene_linear, regex: '.*\\.([eE][xX][rR]|[hH][dD][rR])'}
  - !<Rule> {name: Display-encoded files, colorspace: sRGB, regex: '.*\\.([pP][nN][gG]|[jJ][pP][eE]?[gG])'}
  - !<Rule> {name: Default, colorspace: Non-Color}
displays:
  sRGB:
    - !<View> {name: Standard, view_transform: Un-tone-mapped, display_colorspace: sRGB - Display}
    - !<View> {name: Raw, colorspace: Non-Color}
  Rec.709:
    - !<View> {name: Standard, view_transform: Un-tone-mapped, display_colorspace: Rec.1886 Rec.709 - Display}
    - !<View> {name: Raw, colorspace: Non-Color}
active_displays: [sRGB, Rec.709]
active_views: [Standard, Raw]
default_view_transform: Un-tone-mapped
view_transforms:
  - !<ViewTransform>
    name: Un-tone-mapped
    description: Scene-linear light shown as it is, clipped at display white.
    from_scene_reference: !<MatrixTransform> {matrix: [0.412390799266, 0.357584339384, 0.180480788402, 0, \
0.212639005872, 0.715168678768, 0.072192315361, 0, 0.019330818716, 0.119194779795, 0.950532152250, 0, 0, 0, 0, 1]}
display_colorspaces:
  - !<ColorSpace>
    name: CIE-XYZ-D65
    aliases: [cie_xyz_d65]
    description: CIE XYZ with a D65 white, through which displays are connected.
    bitdepth: 32f
  - !<ColorSpace>
    name: sRGB - Display
    aliases: [srgb_display, srgb_rec709_display]
    family: Display
    encoding: sdr-video
    description: An sRGB monitor (IEC 61966-2-1, piecewise).
    bitdepth: 32f
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
  - !<ColorSpace>
    name: Rec.1886 Rec.709 - Display
    aliases: [rec1886_rec709_display]
    family: Display
    encoding: sdr-video
    description: An HD video monitor (Rec.709 primaries, Rec.1886 EOTF).
    bitdepth: 32f
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_REC.1886-REC.709}
colorspaces:
  - !<ColorSpace>
    name: Linear Rec.709
    aliases: [lin_rec709_scene, lin_rec709, lin_rec709_srgb, lin_srgb, Linear, Linear Rec.709 (sRGB), Linear BT.709, \
Utility - Linear - Rec.709, Utility - Linear - sRGB]
    family: Scene-linear
    encoding: scene-linear
    description: Scene-linear light, Rec.709 primaries, D65 white; the reference.
    bitdepth: 32f
  - !<ColorSpace>
    name: ACES2065-1
    aliases: [aces2065_1, lin_ap0, lin_ap0_scene]
    family: Scene-linear
    encoding: scene-linear
    description: Scene-linear light, ACES AP0 primaries, for exchange between configs.
    bitdepth: 32f
    from_reference: !<MatrixTransform> {matrix: REC709_TO_AP0}
  - !<ColorSpace>
    name: ACEScg
    aliases: [acescg, lin_ap1, lin_ap1_scene]
    family: Scene-linear
    encoding: scene-linear
    description: Scene-linear light, ACES AP1 primaries.
    bitdepth: 32f
    to_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
        - !<MatrixTransform> {matrix: REC709_TO_AP0, direction: inverse}
  - !<ColorSpace>
    name: ACEScct
    aliases: [acescct_ap1]
    family: Log
    encoding: log
    description: Logarithmic light, ACES AP1 primaries, for grading.
    bitdepth: 32f
    to_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: ACEScct_to_ACES2065-1}
        - !<MatrixTransform> {matrix: REC709_TO_AP0, direction: inverse}
  - !<ColorSpace>
    name: sRGB
    aliases: [sRGB - Texture, srgb_tx, srgb_texture, srgb_rec709_scene, Utility - sRGB - Texture]
    family: Display-encoded
    encoding: sdr-video
    description: Textures and pictures without a response of their own (IEC 61966-2-1, piecewise).
    bitdepth: 32f
    to_reference: !<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055}
  - !<ColorSpace>
    name: Non-Color
    aliases: [Raw, Utility - Raw, Non-Colour Data, Generic Data]
    family: Data
    encoding: data
    description: Numbers that are no colours (masks, normals, depth); never converted.
    bitdepth: 32f
    isdata: true
"""


def portable_config(spaces: Sequence[PlateColorSpace]) -> OCIO.Config:
    """Return a profile 2.0 config with `spaces`, for every host from OpenColorIO 2.0 on.

    Its reference and scene-linear space is linear Rec.709 with a D65 white.

    Parameters
    ----------
    spaces : sequence of PlateColorSpace
        The plates, of different names.

    Raises
    ------
    ConfigError
        If two spaces share a name or an alias, or one takes a name of the config.
    """
    rows = [str([*row, 0])[1:-1] for row in REC709_TO_AP0]
    config = OCIO.Config.CreateFromStream(PORTABLE.replace("REC709_TO_AP0", f"[{', '.join(rows)}, 0, 0, 0, 1]"))
    names = [space.name.casefold() for space in spaces]
    for index, space in enumerate(spaces):
        if names.index(names[index]) != index:
            raise ConfigError(f"{space.name}: two plates have this name; rename one")
        config = add_plate_color_space(config, space)
    return config

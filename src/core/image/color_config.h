// The OpenColorIO configuration that ships with Lampyris, as text. Its reference space is what the renderer computes
// in: scene-linear light with Rec.709 primaries and D65 white.
#pragma once

namespace lampyris {

inline constexpr const char* kColorConfig = R"config(ocio_profile_version: 2

name: lampyris
description: Scene-linear Rec.709 in, an sRGB display out.
strictparsing: true

roles:
  scene_linear: Linear Rec.709
  default: Linear Rec.709
  data: Raw

file_rules:
  - !<Rule> {name: Default, colorspace: Linear Rec.709}

displays:
  sRGB:
    - !<View> {name: Standard, colorspace: sRGB}
    - !<View> {name: ACES, colorspace: ACES SDR}
    - !<View> {name: Log, colorspace: Log}
    - !<View> {name: Raw, colorspace: Raw}

active_displays: [sRGB]
active_views: [Standard, ACES, Log, Raw]

colorspaces:
  - !<ColorSpace>
    name: Linear Rec.709
    bitdepth: 32f
    description: Light as the renderer computes it.

  - !<ColorSpace>
    name: sRGB
    bitdepth: 8ui
    description: light times 2^exposure, cut at 1, encoded with sRGB's curve (IEC 61966-2-1)
    from_scene_reference: !<GroupTransform>
      children:
        - !<RangeTransform> {min_in_value: 0, min_out_value: 0, max_in_value: 1, max_out_value: 1}
        - !<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055, direction: inverse}

  - !<ColorSpace>
    name: ACES SDR
    bitdepth: 8ui
    description: the film-like tone curve of ACES 1.0 (RRT and SDR video output) for an sRGB display
    from_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD, direction: inverse}
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
        - !<BuiltinTransform> {style: ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0}
        - !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}

  - !<ColorSpace>
    name: Log
    bitdepth: 8ui
    description: the logarithm of light, from 10 stops below middle grey (0.18) to 6.5 above it
    from_scene_reference: !<AllocationTransform> {allocation: lg2, vars: [-12.473931, 4.026069]}

  - !<ColorSpace>
    name: Raw
    bitdepth: 32f
    isdata: true
    description: the numbers as they are, cut at 0 and 1
)config";

}  // namespace lampyris

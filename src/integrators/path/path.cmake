lampyris_kernel(path.radiance.h
  CPU_EFFECTS kAllEffects kTexturedEffects kGlassEffects kSkyEffects
    "kGlassEffects | EFFECT_LAYERED_COAT"
    "kDiffuseEffects | EFFECT_QUADRICS"
    "kDiffuseEffects | EFFECT_QUADRICS | EFFECT_DIELECTRIC"
    "kDiffuseEffects | EFFECT_TEXTURES | EFFECT_IMAGES")

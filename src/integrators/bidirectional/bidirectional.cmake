set(sets kAllEffects kTexturedEffects kGlassEffects "kDiffuseEffects | EFFECT_QUADRICS")
lampyris_kernel(light_subpaths.kernel.h CPU_EFFECTS ${sets})
lampyris_kernel(camera_subpaths.kernel.h CPU_EFFECTS ${sets})

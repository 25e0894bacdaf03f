set(sets kAllEffects kTexturedEffects kGlassEffects "kDiffuseEffects | EFFECT_QUADRICS")
lampyris_kernel(mlt_chains.kernel.h CPU_EFFECTS ${sets})
lampyris_kernel(mlt_pixels.kernel.h CPU_EFFECTS ${sets})

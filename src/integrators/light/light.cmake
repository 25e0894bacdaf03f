set(sets kAllEffects kTexturedEffects kGlassEffects)
lampyris_kernel(light_paths.kernel.h CPU_EFFECTS ${sets})
lampyris_kernel(light_pixels.kernel.h CPU_EFFECTS ${sets})

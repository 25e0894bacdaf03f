set(sets kAllEffects kTexturedEffects kGlassEffects)
lampyris_kernel(light_paths.kernel.h TRACES_RAYS CPU_EFFECTS ${sets})
lampyris_kernel(light_pixels.kernel.h TRACES_RAYS CPU_EFFECTS ${sets})

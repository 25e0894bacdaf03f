set(sets kAllEffects kTexturedEffects kGlassEffects "kDiffuseEffects | EFFECT_QUADRICS")
lampyris_kernel(bdpt_light_paths.kernel.h TRACES_RAYS CPU_EFFECTS ${sets})
lampyris_kernel(bdpt_camera_paths.kernel.h TRACES_RAYS CPU_EFFECTS ${sets})

// Everything that a rendering kernel needs, ordered so that GLSL has each function before its use.
#ifndef LAMPYRIS_KERNEL_SCENE
#define LAMPYRIS_KERNEL_SCENE

#include "core/kernel/prelude.h"
#ifndef __cplusplus  // C++ has the layouts in its namespace already (cpp_kernel.h)
#include "core/kernel/effects.h"
#include "core/kernel/layout.h"
#include "core/kernel/path_log_layout.h"
#include "core/kernel/scene_buffers.h"
#endif
#include "core/kernel/bindings.h"
#include "core/kernel/surface.h"
#include "core/kernel/math.h"
#include "core/kernel/spectrum.h"
#include "core/kernel/path_log.h"
#include "core/kernel/random.h"
#include "core/kernel/sampling.h"
#include "core/kernel/texture.h"
#include "core/kernel/shapes.h"
#include "core/kernel/trace.h"
#include "core/kernel/bsdf.h"
#include "core/kernel/material.h"
#include "core/kernel/medium.h"
#include "core/kernel/intersect.h"
#include "core/kernel/light.h"
#include "core/kernel/emission.h"
#include "core/kernel/camera.h"
#include "core/kernel/walk.h"
#include "core/kernel/direct_light.h"

// Called before and after each invocation of a kernel that reads the scene (entry.glsl, cpu_kernel.cpp.in).
FN void invocation_begin() {
    traced_rays[0] = 0u;
    walk_turn[0] = 0u;
    walk_turns[0] = 0u;
    PATH_LOG(log_path(LOG_CAMERA_PATH, 0u, 0u));  // unless the kernel says otherwise
}
FN void invocation_end() { walk_check(); }

#endif

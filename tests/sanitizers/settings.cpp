// Settings that programs with sanitizers link.
#include <dlfcn.h>

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the runtimes' names

// A finding ends the program, so that no test passes despite one. UBSAN_OPTIONS=halt_on_error=0 continues, to show all of them.
const char* __ubsan_default_options() { return "halt_on_error=1:print_stacktrace=1"; }

const char* __lsan_default_options() { return "print_suppressions=0"; }

// Leaks that are not ours:
// - Khronos' validation layer (1.3.239) leaks records of shaders and pipelines that refer to each other. All are indirect
// leaks, and the layer reports no object that is left when a device is destroyed.
// - Mesa's lavapipe (25.0.7) leaks empty memory contexts, of 48 bytes each, when it compiles a shader that is not in its cache:
// trace_test leaks 49 of them with an empty cache, and none when it runs again. The validation layer would report leaked Vulkan
// objects of ours (validation_test).
const char* __lsan_default_suppressions() { return "leak:libVkLayer_khronos_validation.so\nleak:libvulkan_lvp.so\n"; }

// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
}

// A loaded library stays loaded. What a Vulkan driver keeps in its variables until the process ends (Mesa's lavapipe does)
// would be a leak to LeakSanitizer, and one without a stack, once the Vulkan loader has unloaded the driver together with its
// variables.
int dlclose(void* /*handle*/) noexcept { return 0; }

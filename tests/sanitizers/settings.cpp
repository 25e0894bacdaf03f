// What programs with sanitizers link.
#include <dlfcn.h>

// A finding ends the program: no test passes in spite of one. UBSAN_OPTIONS=halt_on_error=0 goes on, to see them all.
extern "C" const char* __ubsan_default_options() {  // NOLINT(bugprone-reserved-identifier): the runtime's name
    return "halt_on_error=1:print_stacktrace=1";
}

// A library that is loaded stays loaded. What a Vulkan driver holds in its variables until the process ends (Mesa's
// lavapipe does) would be a leak to LeakSanitizer, and one without a stack, once the Vulkan loader has unloaded the driver
// and its variables with it.
int dlclose(void* /*handle*/) noexcept { return 0; }

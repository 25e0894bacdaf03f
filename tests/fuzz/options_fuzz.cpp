// Any text is a choice of a plugin with settings, or an InputError; and settings that are shown are read back as they were.
#include "core/base/error.h"
#include "core/base/parameters.h"
#include "core/kernel/params.h"

#include <cassert>
#include <cstring>

using namespace lampyris;

namespace {

#define FUZZ_PARAMS(P)                             \
    P(int, depth, 5, -1, 100000, "a whole number") \
    P(float, alpha, 0.7f, 0.01f, 1, "a number")    \
    P(uint, slots, 2, 1, 8, "a positive one")      \
    P(uint, schedule, 0, 0, 1, "{shared|memoryless} a word")
PARAMS(FuzzParams, FUZZ_PARAMS)

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const ParameterFields fields = PARAMETER_FIELDS(FuzzParams, FUZZ_PARAMS);
    FuzzParams params{}, again{};
    set_defaults(&params, fields);
    set_defaults(&again, fields);
    try {
        const PluginChoice choice = parse_plugin_choice({reinterpret_cast<const char*>(data), size});
        for (const auto& [key, value] : choice.settings) set_parameter(&params, fields, key, value, "fuzz");
    } catch (const InputError&) {}
    assert(params.depth >= -1 && params.depth <= 100000 && params.alpha >= 0.01f && params.alpha <= 1.0f);
    assert(params.slots >= 1 && params.slots <= 8 && params.schedule <= 1);
    for (const auto& [key, value] : show_parameters(&params, fields)) set_parameter(&again, fields, key, value, "fuzz");
    assert(std::memcmp(&params, &again, sizeof params) == 0);
    return 0;
}

// A tiny object that needs the effects of several tests' scenes, so that these scenes have one set of effects: a CPU's Vulkan
// driver takes 20 seconds and more to compile the kernels of each set.
#pragma once

#include <fmt/format.h>

#include <string>

namespace lampyris::test {

// A speck of 0.01 around (0, 0, z): masked and mixed, of glass and matte, in an instance; and lights that emit nearly nothing.
// Its materials are named "speck-...".
inline std::string one_of_each(double z) {
    return fmt::format(
        "MakeNamedMaterial \"speck-matte\" \"string type\" \"diffuse\"\n"
        "MakeNamedMaterial \"speck-pane\" \"string type\" \"thindielectric\"\n"
        "MakeNamedMaterial \"speck-both\" \"string type\" \"mix\" \"string materials\" [ \"speck-pane\" "
        "\"speck-matte\" ] "
        "\"float amount\" 0.5\n"
        "LightSource \"distant\" \"rgb L\" [ 1e-9 1e-9 1e-9 ]\n"
        "ObjectBegin \"speck\"\nNamedMaterial \"speck-both\"\n"
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 {0} 0.005 0 {0} 0 0.005 {0} ] \"integer indices\" [ 0 1 2 ] "
        "\"float alpha\" 0.5\nObjectEnd\nObjectInstance \"speck\"\n"
        "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 1e-9 1e-9 1e-9 ]\n"
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 {0} -0.005 0 {0} 0 -0.005 {0} ] \"integer indices\" [ 0 1 2 ]\n"
        "AttributeEnd\n",
        z);
}

}  // namespace lampyris::test

#include "commands/foreign_words.h"

#include <fmt/format.h>

#include <array>

namespace lampyris {
namespace {

struct Option {
    std::string_view theirs, whose, ours;
};

constexpr std::array kOptions{
    Option{"--outfile", "pbrt", "-o IMAGE"},
    Option{"--nthreads", "pbrt", "--threads N"},
    Option{"--gpu", "pbrt", "--backend vulkan"},
    Option{"--wavefront", "pbrt", "--backend cpu or vulkan"},
    Option{"--gpu-device", "pbrt", "--backend vulkan --device N"},
    Option{"--mse-reference-image", "pbrt", "--reference REF.exr"},
    Option{"--mse-reference-out", "pbrt", "--stats FILE.json"},
    Option{"--pixel", "pbrt", "--crop x,y,x+1,y+1 (one sample alone: --replay X,Y,PASS)"},
    Option{"--pixelbounds", "pbrt", "--crop x0,y0,x1,y1 (pbrt's order is x0,x1,y0,y1)"},
    Option{"--cropwindow", "pbrt", "--crop x0,y0,x1,y1, in pixels"},
    Option{"--debugstart", "pbrt", "--replay X,Y,PASS"},
    Option{"--quick", "pbrt", "--spp 4 --resolution WxH"},
    Option{"--samples", "others", "--spp N"},
    Option{"--width", "others", "--resolution WxH"},
    Option{"--height", "others", "--resolution WxH"},
    Option{"-m", "Mitsuba", "--backend NAME; there are no variants, light is always RGB"},
    Option{"--mode", "Mitsuba", "--backend NAME; there are no variants, light is always RGB"},
    Option{"-t", "Mitsuba", "--threads N"},
    Option{"-D", "Mitsuba", "--set SECTION.KEY=VALUE"},
    Option{"--define", "Mitsuba", "--set SECTION.KEY=VALUE"},
    Option{"-s", "Mitsuba", "one camera, the scene file's"},
    Option{"--sensor", "Mitsuba", "one camera, the scene file's"},
    Option{"-a", "Mitsuba", "--plugin FILE.so"},
};

struct Plugin {
    std::string_view kind, name, whose, ours;  // an empty name: any
};

constexpr std::array kPlugins{
    Plugin{"light", "area", "Mitsuba", "area light"},
    Plugin{"light", "diffuse", "pbrt", "area light"},
    Plugin{"light", "constant", "Mitsuba", "light infinite"},
    Plugin{"light", "envmap", "Mitsuba", "light infinite"},
    Plugin{"light", "directional", "Mitsuba", "light distant"},
    Plugin{"emitter", "area", "Mitsuba", "area light"},
    Plugin{"arealight", "", "pbrt", "area light"},
    Plugin{"area-light", "", "pbrt", "area light"},
    Plugin{"emitter", "", "Mitsuba", "light"},
    Plugin{"bsdf", "", "Mitsuba", "material"},
    Plugin{"sensor", "", "Mitsuba", "camera"},
    Plugin{"rfilter", "", "Mitsuba", "filter"},
    Plugin{"pixelfilter", "", "pbrt", "filter"},
};

}  // namespace

std::string advice_on_option(std::string_view option) {
    for (const Option& known : kOptions)
        if (known.theirs == option)
            return fmt::format("; what {} calls {} is here: {}", known.whose, known.theirs, known.ours);
    return {};
}

std::string advice_on_plugin(std::string_view kind, std::string_view name) {
    for (const Plugin& known : kPlugins)
        if (known.kind == kind && (known.name.empty() || known.name == name)) {
            const bool spaced = known.ours == "area light";
            return fmt::format("; what {} calls so is listed by: lampyris plugins {}", known.whose,
                               spaced ? "\"area light\"" : known.ours);
        }
    return {};
}

}  // namespace lampyris

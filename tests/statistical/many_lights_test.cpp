// Scenes of so many lights that they are chosen by a tree (core/kernel/light_tree.h): every method finds the same light. Methods
// that start from lights choose them by power, and weigh both choices against each other.
//
// False alarms: 1e-6 a comparison, 6 of them; fixed seeds.
#include "support/agreement.h"
#include "support/device_run.h"
#include "support/runs.h"

#include <fmt/format.h>

#include <random>

namespace lampyris::test {
namespace {

// A closed room of albedo 1/2 with a wall across, and lamps of all kinds, from .01 to 10 times as strong as each other.
std::string room() {
    std::mt19937 random(4);
    const auto number = [&](double low, double high) { return low + (high - low) * (random() / 4294967296.0); };
    std::string text =
        "LookAt -.8 -.7 .3  1 1 -.2  0 0 1\nCamera \"perspective\" \"float fov\" 80\nFilm \"rgb\" \"integer "
        "xresolution\" 8 "
        "\"integer yresolution\" 8\nPixelFilter \"box\"\nSampler \"independent\"\nWorldBegin\n"
        "Material \"diffuse\" \"rgb reflectance\" [ .5 .5 .5 ]\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 -1 1 -1 -1 1 1 -1 -1 1 -1 -1 -1 1 1 -1 1 1 1 1 -1 1 1 ] \"integer "
        "indices\" "
        "[ 0 1 2 0 2 3 4 6 5 4 7 6 0 5 1 0 4 5 1 6 2 1 5 6 2 7 3 2 6 7 3 4 0 3 7 4 ]\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -.3 .2 -1 1 .2 -1 1 .2 .4 -.3 .2 .4 ] \"integer indices\" [ 0 1 2 0 2 3 "
        "]\n";
    for (int i = 0; i < 24; ++i) {
        const double strength = std::pow(10.0, number(-2, 1));
        text += fmt::format("AttributeBegin Translate {} {} {} Rotate {} {} {} 1\n", number(-.6, .6), number(-.6, .6),
                            number(-.6, .6), number(0, 360), number(-1, 1), number(-1, 1));
        const std::string light = "AreaLightSource \"diffuse\" \"rgb L\" [ {0} {0} {0} ] ";
        const std::string kinds[] = {
            "LightSource \"point\" \"rgb I\" [ {0} {0} {0} ]",
            "LightSource \"spot\" \"rgb I\" [ {0} {0} {0} ] \"float coneangle\" 50",
            light + "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 .2 0 0 0 .2 0 ]",
            light + "Shape \"sphere\" \"float radius\" .1",
        };
        text +=
            fmt::format(fmt::runtime(kinds[i % 4]), i % 4 < 2 ? 0.1 * strength : strength * 10) + "\nAttributeEnd\n";
    }
    return text;
}

TEST(ManyLights, AllMethodsFindTheSame) {
    constexpr uint32_t kRuns = 16;
    const std::string text = room();
    const Mean path = mean_of_text_runs(text, settings_of("cpu", "path:maxdepth=3", 256, 0), kRuns);
    EXPECT_LT(path.error(), 0.006 * path.value());
    for (const char* integrator : {"bdpt:maxdepth=3", "vcm:maxdepth=3,radius=0.01",
                                   "mlt:maxdepth=3,bootstrapsamples=4096", "light:maxdepth=3"}) {
        SCOPED_TRACE(integrator);
        const Mean other = mean_of_text_runs(text, settings_of("cpu", integrator, 128, 0), kRuns);
        fmt::print("{:40} {:.5g} +- {:.2g}, path {:.5g} +- {:.2g}\n", integrator, other.value(), other.error(),
                   path.value(), path.error());
        // Student's t with about 30 degrees of freedom exceeds 6.1 with a probability of 1e-6.
        EXPECT_LT(std::abs(other.value() - path.value()), 6.1 * std::hypot(other.error(), path.error()));
        EXPECT_LT(other.error(), 0.01 * path.value());
    }
}

// The weights of light samples and of paths from lights add up to one only if both know by which probability the other chose. A
// light near the floor that is seen is chosen often by the tree and seldom by power: it has a 450th of all power.
TEST(ManyLights, ChoicesOfBothKindsAreWeighed) {
    constexpr uint32_t kRuns = 16;
    std::string text =
        "LookAt 0 -.5 1.5  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 60\nFilm \"rgb\" \"integer "
        "xresolution\" 8 \"integer yresolution\" 8\nPixelFilter \"box\"\nSampler \"independent\"\nWorldBegin\n"
        "Material \"diffuse\" \"rgb reflectance\" [ .5 .5 .5 ]\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -200 -200 0 200 -200 0 200 200 0 -200 200 0 ] \"integer indices\" "
        "[ 0 1 2 0 2 3 ]\n";
    for (int i = 0; i < 16; ++i)
        text += fmt::format("LightSource \"point\" \"point3 from\" [ {} 0 1 ] \"rgb I\" [ {} 0 0 ]\n", 6 * i,
                            i == 0 ? 1 : 30);
    const Mean path = mean_of_text_runs(text, settings_of("cpu", "path:maxdepth=2", 512, 0), kRuns);
    for (const char* integrator : {"bdpt:maxdepth=2", "vcm:maxdepth=2,radius=0.01"}) {
        SCOPED_TRACE(integrator);
        const Mean other = mean_of_text_runs(text, settings_of("cpu", integrator, 512, 0), kRuns);
        const double error = std::hypot(other.error(), path.error());
        EXPECT_LT(std::abs(other.value() - path.value()), 6.1 * error);
        EXPECT_LT(error, 0.003 * path.value());
    }
}

// No other scene that is compared on all backends has many lights.
TEST(ManyLights, SameOnEveryBackend) {
    RenderSettings settings = settings_of("cpu", "path:maxdepth=3", 4, 16);
    const Rendered cpu = render_text(room(), settings);
    for (const std::string& backend : usable_backends()) {
        if (backend == "cpu") continue;
        settings.backend = backend;
        settings.device_settings = exact_options(backend).settings;
        const Agreement found = agreement(cpu, render_text(room(), settings), 1e-5);
        EXPECT_GE(found.share(), 0.99) << backend;
    }
}

}  // namespace
}  // namespace lampyris::test

// Scenes that name an integrator of pbrt-v4: its replacement gives the same numbers, to the bit, as when it is requested by its
// own name, and these numbers are right. False alarms: 6e-7 for each mean (five standard errors), below 4e-6 in all.
#include "core/render/integrator.h"
#include "core/render/pbrt_integrators.h"
#include "support/build_text.h"
#include "support/render.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace lampyris::test {
namespace {

// Inside of a closed box that emits 1 and reflects 0.9, radiance is the sum of 0.9^k over the k = 0 to maxdepth bounces.
std::string furnace(const std::string& integrator) {
    return "Camera \"perspective\" \"float fov\" 60\n"
           "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n" +
           integrator +
           "\nWorldBegin\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.9 0.9 0.9 ]\n"
           "AreaLightSource \"diffuse\" \"bool twosided\" true\n"
           "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1  -1 -1 1  1 -1 1  1 1 1  -1 1 1 "
           "]\n"
           "\"integer indices\" [ 0 1 2 0 2 3  4 5 6 4 6 7  0 1 5 0 5 4  3 2 6 3 6 7  0 3 7 0 7 4  1 2 6 1 6 5 ]\n";
}

double furnace_radiance(int maxdepth) { return (1.0 - std::pow(0.9, maxdepth + 1)) / (1.0 - 0.9); }

class PbrtIntegrators : public testing::TestWithParam<std::string> {
 protected:
    static Rendered render(const std::string& scene, const std::string& integrator = "", uint32_t samples = 64) {
        RenderSettings s;
        s.backend = GetParam();
        s.samples = samples;
        s.integrator = integrator;
        return render_text(scene, s);
    }
    static bool same(const Rendered& a, const Rendered& b) {
        return a.pixels.size() == b.pixels.size() &&
               std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(a.pixels[0])) == 0;
    }
    static void expect_mean(const Rendered& image, double expected) {
        double variance = 0.0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) variance += image.luminance_variance(x, y);
        const double pixels = double(image.width) * image.height;
        EXPECT_NEAR(image.mean_luminance(), expected, 5.0 * std::sqrt(variance) / pixels + 1e-5 * expected);
    }
};

TEST_P(PbrtIntegrators, TheDefaultIsPath) {
    const Rendered image = render(furnace(""));
    EXPECT_TRUE(same(image, render(furnace("Integrator \"path\""))));
    EXPECT_TRUE(same(image, render(furnace(""), "path")));
    expect_mean(image, furnace_radiance(5));
}

TEST_P(PbrtIntegrators, VolpathIsPathWithItsDepth) {
    const Rendered deep = render(furnace("Integrator \"volpath\" \"integer maxdepth\" 50"));
    EXPECT_TRUE(same(deep, render(furnace("Integrator \"path\" \"integer maxdepth\" 50"))));
    EXPECT_TRUE(same(deep, render(furnace(""), "path:maxdepth=50")));
    expect_mean(deep, furnace_radiance(50));
    const Rendered shallow = render(furnace("Integrator \"volpath\""));
    EXPECT_TRUE(same(shallow, render(furnace(""))));
    EXPECT_FALSE(same(shallow, deep));
    const Rendered three =
        render(furnace("Integrator \"volpath\" \"string lightsampler\" \"uniform\" \"bool regularize\" "
                       "false \"integer maxdepth\" 3"));
    expect_mean(three, furnace_radiance(3));
}

TEST_P(PbrtIntegrators, OthersKeepTheirDepth) {
    const Rendered path = render(furnace(""), "path:maxdepth=2", 16);
    for (const PbrtIntegrator& known : pbrt_integrators()) {
        if (known.ours != "path" || known.name == "function") continue;
        const std::string line = fmt::format("Integrator \"{}\" \"integer maxdepth\" 2", known.name);
        EXPECT_TRUE(same(path, render(furnace(line), "", 16))) << known.name;
    }
}

// Seen from a point of the sphere, the surface in the direction at angle a to the normal is at distance 2 cos a: beyond a
// distance d lies the share 1 - d^2 / 4 of all directions, weighted with the cosine.
TEST_P(PbrtIntegrators, AmbientOcclusionIsAo) {
    const std::string line = "Integrator \"ambientocclusion\" \"bool cossample\" true \"float maxdistance\" 1";
    const auto ball = [](const std::string& integrator) {
        return "Camera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n" +
               integrator + "\nWorldBegin\nShape \"sphere\"\n";
    };
    const Rendered image = render(ball(line));
    EXPECT_TRUE(same(image, render(ball(""), "ao:distance=1")));
    expect_mean(image, 0.75);
    expect_mean(render(ball("Integrator \"ambientocclusion\"")), 0.0);
}

// A plane lamp behind a metre of a medium that transmits exp(-2) of its light, or all of it if media are ignored.
std::string tinted(const std::string& integrator, bool medium, const std::string& sigma = "0 0 0") {
    const std::string define =
        "MakeNamedMedium \"tea\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 2 2 2 ] \"rgb "
        "sigma_s\" [ " +
        sigma + " ]\nMediumInterface \"tea\" \"\"\n";
    return (medium ? define : std::string()) +
           "Camera \"orthographic\" \"float screenwindow\" [ -0.1 0.1 -0.1 0.1 ]\n"
           "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\n" +
           integrator + "\nWorldBegin\nTranslate 0 0 1\nMediumInterface \"" + (medium ? "tea" : "") + "\" \"" +
           (medium ? "tea" : "") +
           "\"\nMaterial \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\nAreaLightSource \"diffuse\" \"bool twosided\" "
           "true\n"
           "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0  1 -1 0  0 2 0 ]\n";
}

TEST_P(PbrtIntegrators, MediaCanBeLeftOut) {
    std::string in_tea = tinted("Integrator \"path\"", true);
    // The camera is in the medium, too.
    in_tea.replace(in_tea.find("MediumInterface \"tea\" \"\""), 24, "MediumInterface \"\" \"tea\"");
    const Rendered absorbed = render(in_tea, "", 4);
    expect_mean(absorbed, std::exp(-2.0));
    std::string volpath = in_tea;
    volpath.replace(volpath.find("\"path\""), 6, "\"volpath\"");
    EXPECT_TRUE(same(absorbed, render(volpath, "", 4)));
    const Rendered clear = render(tinted("Integrator \"path\"", false), "", 4);
    expect_mean(clear, 1.0);
    const std::string off = "Integrator \"path\" \"string media\" \"off\"";
    EXPECT_TRUE(same(clear, render(tinted(off, true), "", 4)));
    // pbrt-v4's path renders scattering media as if there were none.
    EXPECT_TRUE(same(clear, render(tinted(off, true, "1 1 1"), "", 4)));
}

INSTANTIATE_TEST_SUITE_P(Backends, PbrtIntegrators, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return info.param == "cpu-bvh2" ? "cpu_bvh2" : info.param; });

TEST(PbrtIntegratorTable, NamesWhatIsThere) {
    for (const PbrtIntegrator& known : pbrt_integrators()) {
        const PluginInfo* ours = integrators().find_info(known.ours);
        ASSERT_NE(ours, nullptr) << known.name;
        EXPECT_TRUE(known.name == known.ours || !known.difference.empty()) << known.name;
        for (const PbrtParameter& parameter : known.parameters) {
            EXPECT_NE(parameter.ours.empty(), parameter.otherwise.empty()) << parameter.name;
            if (parameter.ours.empty()) continue;
            const ParameterSpec* spec = find_spec(ours->parameters, parameter.ours);
            ASSERT_NE(spec, nullptr) << known.name << " " << parameter.name;
            EXPECT_EQ(spec->type, parameter.type);
        }
    }
}

}  // namespace
}  // namespace lampyris::test

// Scenes that no sane person writes, but generators do: each renders something sane on every backend, or is refused with the
// location of the mistake. Nothing crashes, hangs, or silently makes samples that are not finite.
#include "core/base/memory.h"
#include "support/render.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lampyris::test {
namespace {

enum class Expect {
    kBlack,
    kLit,
    kFinite
};  // every pixel 0; some pixel above 0; all pixels finite, whatever their values

struct Case {
    std::string name;
    std::string world;       // after WorldBegin
    std::string error = {};  // what the error must contain; empty: it renders
    Expect expect = Expect::kFinite;
    std::string view = "LookAt 0 0 -4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 50\n";
    std::string film = "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n";
};

const std::string kSky = "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n";
const std::string kSphere = "Shape \"sphere\"\n";

std::string triangle(const std::string& points) {
    return "Shape \"trianglemesh\" \"point3 P\" [ " + points + " ] \"integer indices\" [ 0 1 2 ]\n";
}

std::string repeated(const std::string& text, int times) {
    std::string all;
    for (int i = 0; i < times; ++i) all += text;
    return all;
}

// Nested mixes, each containing the one before.
std::string mixes(int count) {
    std::string text = "MakeNamedMaterial \"m0\" \"string type\" \"diffuse\"\n";
    for (int i = 1; i <= count; ++i) {
        const std::string before = std::to_string(i - 1);
        text += "MakeNamedMaterial \"m" + std::to_string(i) + "\" \"string type\" \"mix\" \"string materials\" [ \"m" +
                before + "\" \"m0\" ] \"float amount\" 0\n";
    }
    return text + "NamedMaterial \"m" + std::to_string(count) + "\"\n";
}

std::string instances(int count) {
    std::string text = "ObjectBegin \"o\"\nShape \"disk\" \"float radius\" 0.1\n" +
                       triangle("-.1 -.1 0 .1 -.1 0 0 .1 0") + "ObjectEnd\n";
    for (int i = 0; i < count; ++i)
        text += "AttributeBegin Translate " + std::to_string(0.05 * (i % 50) - 1.25) + " " +
                std::to_string(0.05 * double(i / 50) - 1.25) + " 0 ObjectInstance \"o\" AttributeEnd\n";
    return text;
}

std::string area_light(const std::string& parameters) {
    return "AttributeBegin\nAreaLightSource \"diffuse\" " + parameters +
           "\nTranslate 0 2 0\nRotate 90 1 0 0\nShape \"disk\" \"float radius\" 0.5\nAttributeEnd\n" + kSphere;
}

const std::vector<Case>& cases() {
    const std::string straight = "Camera \"perspective\"\n";
    static const std::vector<Case> all = {
        // Triangles and other shapes without area, or with too much
        {"a triangle that is a point", kSky + triangle("0 0 0 0 0 0 0 0 0"), "", Expect::kLit},
        {"a triangle that is a line", kSky + triangle("-1 0 0 0 0 0 1 0 0"), "", Expect::kLit},
        {"a light that is a point", area_light("") + "AreaLightSource \"diffuse\"\n" + triangle("0 0 0 0 0 0 0 0 0"),
         "", Expect::kLit},
        {"a light that is a line", kSphere + "AreaLightSource \"diffuse\"\n" + triangle("-1 2 0 0 2 0 1 2 0"), "",
         Expect::kBlack},
        {"a patch that is a point",
         kSky + "AreaLightSource \"diffuse\"\nShape \"bilinearmesh\" \"point3 P\" [ 0 0 0 0 0 0 0 0 0 0 0 0 ]\n", "",
         Expect::kLit},
        {"a patch with a corner twice",
         kSky + "AreaLightSource \"diffuse\"\nShape \"bilinearmesh\" \"point3 P\" [ -1 -1 0 1 -1 0 -1 1 0 -1 1 0 ]\n",
         "", Expect::kLit},
        {"a patch that crosses itself", kSky + "Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 0 1 1 0 1 -1 0 -1 1 0 ]\n",
         "", Expect::kLit},
        {"normals of length zero",
         kSky + "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0 1 -1 0 0 1 0 ] \"normal N\" [ 0 0 0 0 0 0 0 0 0 ]\n", "",
         Expect::kLit},
        {"normals that cancel",
         kSky + "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0 1 -1 0 0 1 0 ] \"normal N\" [ 0 0 1 0 0 -1 0 0 1 ]\n",
         "", Expect::kLit},
        {"normals in the plane",
         kSky + "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0 1 -1 0 0 1 0 ] \"normal N\" [ 1 0 0 1 0 0 1 0 0 ]\n", "",
         Expect::kFinite},
        {"uv all alike under a bump map",
         kSky + "Texture \"w\" \"float\" \"wrinkled\"\nMaterial \"diffuse\" \"texture displacement\" \"w\"\nShape "
                "\"trianglemesh\" \"point3 P\" [ -1 -1 0 1 -1 0 0 1 0 ] \"point2 uv\" [ 0 0 0 0 0 0 ]\n",
         "", Expect::kLit},
        {"a mesh far away", kSky + triangle("-1e11 -1e11 1e11 1e11 -1e11 1e11 0 1e11 1e11"), "", Expect::kLit},
        {"a mesh somewhat too far away", kSky + triangle("-1e13 0 0 1e13 0 0 0 1e13 0"), "at most 1e+12"},
        {"a mesh too far away", kSky + triangle("-1e30 0 0 1e30 0 0 0 1e30 0"), "farther out than rays are traced"},
        {"a mesh scaled out of the world", kSky + "Scale 1e15 1e15 1e15\n" + triangle("-1e9 0 0 1e9 0 0 0 1e9 0"),
         "farther out than rays are traced"},
        {"an instance out of the world",
         kSky + "ObjectBegin \"o\"\n" + kSphere + "ObjectEnd\nTranslate 1e20 0 0\nObjectInstance \"o\"\n",
         "farther out than rays are traced"},
        {"an instance of next to nothing",
         kSky + "ObjectBegin \"o\"\n" + kSphere + triangle("0 0 0 1 0 0 0 1 0") +
             "ObjectEnd\nScale 1e-19 1e-19 1e-19\nObjectInstance \"o\"\n",
         "too small beside the scene"},
        {"a tiny instance",
         kSky + kSphere + "ObjectBegin \"o\"\n" + kSphere + triangle("0 0 0 1 0 0 0 1 0") +
             "ObjectEnd\nScale 1e-15 1e-15 1e-15\nObjectInstance \"o\"\n",
         "", Expect::kLit},
        {"a sphere out of the world", kSky + "Shape \"sphere\" \"float radius\" 1e30\n",
         "farther out than rays are traced"},
        {"a tiny scene", kSky + triangle("-1e-20 0 0 1e-20 0 0 0 1e-20 0"), "too small for rays"},
        {"a tiny mesh", kSky + kSphere + triangle("-1e-30 0 0 1e-30 0 0 0 1e-30 0"), "", Expect::kLit},
        {"a tiny light",
         kSphere + "Translate 0 0 -2\nAreaLightSource \"diffuse\" \"float power\" 1\n" +
             triangle("-1e-25 0 0 1e-25 0 0 0 1e-25 0"),
         "", Expect::kFinite},
        {"a tiny sphere", kSky + kSphere + "Shape \"sphere\" \"float radius\" 1e-30\n", "", Expect::kLit},
        {"a tiny sphere of light",
         kSphere + "Translate 0 0 -2\nAreaLightSource \"diffuse\" \"float power\" 1\nShape \"sphere\" \"float radius\" "
                   "1e-20\n",
         "", Expect::kFinite},
        {"a huge sphere of light",
         kSphere + "AreaLightSource \"diffuse\" \"bool twosided\" true\nShape \"sphere\" \"float radius\" 1e11\n", "",
         Expect::kFinite},
        {"a sphere of a sliver", kSky + "Shape \"sphere\" \"float phimax\" 1e-20\n", "", Expect::kLit},
        // Numbers
        {"not a number", "Shape \"sphere\" \"float radius\" nan\n", "test.pbrt:"},
        {"infinite", "Shape \"sphere\" \"float radius\" inf\n", "test.pbrt:"},
        {"a number beyond floats", triangle("0 0 0 1e39 0 0 0 1 0"), "test.pbrt:"},
        // Transforms
        {"a singular transform", "Scale 0 1 1\n" + kSphere, "cannot be inverted"},
        {"a singular transform of a mesh", "Scale 0 1 1\n" + triangle("0 0 0 1 0 0 0 1 0"), "cannot be inverted"},
        {"a singular transform of an instance",
         "ObjectBegin \"o\"\n" + kSphere + "ObjectEnd\nScale 1 1 0\nObjectInstance \"o\"\n", "cannot be inverted"},
        {"a transform whose inverse is beyond floats", "Scale 1e-42 1e-42 1e-42\n" + kSphere, "cannot be inverted"},
        {"a singular transform of a distant light", "Scale 0 0 0\nLightSource \"distant\"\n",
         "no finite position or direction"},
        {"a singular transform of a spotlight", "Scale 0 0 0\nLightSource \"spot\"\n",
         "no finite position or direction"},
        {"a point light beyond floats", "Scale 1e30 1e30 1e30\nLightSource \"point\" \"point3 from\" [ 1e30 0 0 ]\n",
         "no finite position or direction"},
        {"scaled down and up again",
         kSky + repeated("Scale 1e-10 1e-10 1e-10\n", 3) + repeated("Scale 1e10 1e10 1e10\n", 3) + kSphere, "",
         Expect::kLit},
        {"squashed flat", kSky + "Scale 1 1 1e-12\n" + kSphere, "", Expect::kLit},
        // Cameras and films
        {"a field of view of 0", kSky, "must be above 0", Expect::kFinite, "Camera \"perspective\" \"float fov\" 0\n"},
        {"a field of view of 180", kSky, "179.9", Expect::kFinite, "Camera \"perspective\" \"float fov\" 180\n"},
        {"almost all in view", kSky + kSphere, "", Expect::kLit,
         "Translate 0 0 4\nCamera \"perspective\" \"float fov\" 179.9\n"},
        {"almost nothing in view", kSky + kSphere, "", Expect::kLit,
         "Translate 0 0 4\nCamera \"perspective\" \"float fov\" 1e-20\n"},
        {"the eye at its target", kSky, "LookAt's eye and target are the same point", Expect::kFinite,
         "LookAt 1 1 1 1 1 1 0 1 0\n" + straight},
        {"looking up along up", kSky, "parallel to its viewing direction", Expect::kFinite,
         "LookAt 0 0 0 0 1 0 0 1 0\n" + straight},
        {"a singular camera", kSky, "cannot be inverted", Expect::kFinite, "Scale 0 1 1\n" + straight},
        {"a camera whose inverse is beyond floats", kSky, "cannot be inverted", Expect::kFinite,
         "Scale 1e-42 1e-42 1e-42\n" + straight},
        {"a screen without width", kSky, "screenwindow", Expect::kFinite,
         "Camera \"perspective\" \"float screenwindow\" [ 1 1 0 1 ]\n"},
        {"a lens as wide as the world", kSky + kSphere, "", Expect::kFinite,
         "Translate 0 0 4\nCamera \"perspective\" \"float lensradius\" 1e10 \"float focaldistance\" 1e-10\n"},
        {"no pixels", kSky, "must be 1 to 32768", Expect::kFinite, straight,
         "Film \"rgb\" \"integer xresolution\" 0\n"},
        {"too many pixels", kSky, "must be 1 to 32768", Expect::kFinite, straight,
         "Film \"rgb\" \"integer xresolution\" 2000000000\n"},
        {"a crop window of nothing", kSky, "must not be empty", Expect::kFinite, straight,
         "Film \"rgb\" \"float cropwindow\" [ 0.5 0.5 0 1 ]\n"},
        {"pixel bounds elsewhere", kSky, "are not a part of", Expect::kFinite, straight,
         "Film \"rgb\" \"integer pixelbounds\" [ 2000000000 2147483647 0 8 ]\n"},
        // Lights
        {"an empty scene", "", "", Expect::kBlack},
        {"nothing but sky", kSky, "", Expect::kLit},
        {"no light", kSphere, "", Expect::kBlack},
        {"a light of no power", "LightSource \"point\" \"rgb I\" [ 0 0 0 ] \"point3 from\" [ 0 0 -2 ]\n" + kSphere, "",
         Expect::kBlack},
        {"a light of negative power", "LightSource \"point\" \"float power\" -1\n" + kSphere, "must be at least 0"},
        {"a light of negative colour", "LightSource \"point\" \"rgb I\" [ 1 -1 1 ]\n" + kSphere, "must be at least 0"},
        {"a light of huge power", "LightSource \"point\" \"float power\" 1e30 \"point3 from\" [ 0 0 -2 ]\n" + kSphere,
         "", Expect::kLit},
        {"a light too bright for floats",
         "LightSource \"point\" \"rgb I\" [ 1e30 1e30 1e30 ] \"float scale\" 1e30\n" + kSphere, "not finite"},
        {"an area light too bright for floats", area_light("\"rgb L\" [ 1e30 1e30 1e30 ] \"float scale\" 1e30"),
         "not finite"},
        {"an area light of no power", area_light("\"rgb L\" [ 0 0 0 ]"), "", Expect::kBlack},
        {"an area light of huge power", area_light("\"float power\" 1e25"), "", Expect::kLit},
        {"a dark spectrum",
         "LightSource \"point\" \"spectrum I\" [ 400 0 700 0 ] \"point3 from\" [ 0 0 -2 ]\n" + kSphere, "",
         Expect::kFinite},
        {"a faint blackbody", "LightSource \"point\" \"blackbody I\" 1e-30 \"point3 from\" [ 0 0 -2 ]\n" + kSphere, "",
         Expect::kFinite},
        {"a light on the surface", "LightSource \"point\" \"point3 from\" [ 0 0 -1 ]\n" + kSphere, "", Expect::kFinite},
        {"inside of a light",
         "AreaLightSource \"diffuse\" \"bool twosided\" true\nShape \"sphere\" \"float radius\" 10\n", "",
         Expect::kLit},
        {"inside of a light, seeing its dark side",
         "AreaLightSource \"diffuse\"\nShape \"sphere\" \"float radius\" 10\n", "", Expect::kBlack},
        {"two lights in one place", area_light("") + area_light(""), "", Expect::kLit},
        {"a cone of nothing", "LightSource \"spot\" \"float coneangle\" 1e-20 \"float conedeltaangle\" 0\n" + kSphere,
         "", Expect::kFinite},
        {"a spotlight all around",
         "LightSource \"spot\" \"float coneangle\" 180 \"float conedeltaangle\" 180 \"point3 from\" [ 0 0 -2 ]\n" +
             kSphere,
         "", Expect::kLit},
        // Materials
        {"glass of index 1", kSky + "Material \"dielectric\" \"float eta\" 1\n" + kSphere, "", Expect::kLit},
        {"glass of a huge index", kSky + "Material \"dielectric\" \"float eta\" 1e20\n" + kSphere, "", Expect::kFinite},
        {"roughness next to nothing", kSky + "Material \"conductor\" \"float roughness\" 1e-20\n" + kSphere, "",
         Expect::kLit},
        {"roughness beyond all", kSky + "Material \"conductor\" \"float roughness\" 1e10\n" + kSphere, "",
         Expect::kFinite},
        {"anisotropy", kSky + "Material \"conductor\" \"float uroughness\" 1e-4 \"float vroughness\" 1\n" + kSphere, "",
         Expect::kLit},
        {"a coat of no thickness", kSky + "Material \"coateddiffuse\" \"float thickness\" 0\n" + kSphere, "",
         Expect::kFinite},
        {"a thick murky coat",
         kSky + "Material \"coateddiffuse\" \"float thickness\" 1e10 \"rgb albedo\" [ 1 1 1 ] \"float roughness\" 0\n" +
             kSphere,
         "", Expect::kFinite},
        {"mixes of mixes", kSky + mixes(63) + kSphere, "", Expect::kLit},
        {"mixes of too many mixes", kSky + mixes(64) + kSphere, "nest too deeply"},
        {"mixes without end", kSky + mixes(20000) + kSphere, "nest too deeply"},
        {"a mix of itself",
         kSky +
             "MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [ \"a\" \"a\" ]\nNamedMaterial "
             "\"a\"\n" +
             kSphere,
         "contains itself"},
        {"everywhere transparent", kSky + "Shape \"sphere\" \"float alpha\" 0\n", "", Expect::kLit},
        // Much of it
        {"thousands of instances", kSky + instances(2500), "", Expect::kLit},
        {"thousands of instances in one place",
         kSky + "ObjectBegin \"o\"\n" + kSphere + "ObjectEnd\n" + repeated("ObjectInstance \"o\"\n", 2500), "",
         Expect::kLit},
        {"thousands of triangles in one place",
         kSky + "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0 1 -1 0 0 1 0 ] \"integer indices\" [ " +
             repeated("0 1 2 ", 5000) + "]\n",
         "", Expect::kLit},
        {"deep blocks", kSky + repeated("AttributeBegin\n", 20000) + kSphere + repeated("AttributeEnd\n", 20000), "",
         Expect::kLit},
        {"an object of nothing", kSky + "ObjectBegin \"o\"\nObjectEnd\nObjectInstance \"o\"\n", "", Expect::kLit},
        {"subdivided without end",
         "Shape \"loopsubdiv\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 ] \"integer levels\" "
         "2000000000\n",
         "must be 0 to 12"},
        {"subdivided too far",
         "Shape \"loopsubdiv\" \"point3 P\" [ " + repeated("0 0 0 1 0 0 0 1 0 ", 8) +
             "] \"integer indices\" [ 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 ] \"integer levels\" 12\n",
         "triangles of 6"},
        {"too many samples", kSphere, "must be 1 to", Expect::kFinite,
         "Sampler \"independent\" \"integer pixelsamples\" 2000000000\n" + straight},
    };
    return all;
}

// Throws InputError.
Rendered render(const Case& c, const std::string& backend) {
    RenderSettings settings;
    settings.backend = backend;
    settings.samples = 4;
    settings.sampler = "independent";
    settings.integrator = "path";
    settings.share_device = true;
    return render_text(c.view + c.film + "WorldBegin\n" + c.world, settings, "/nonexistent");
}

class Degenerate : public testing::TestWithParam<std::string> {};

TEST_P(Degenerate, IsRenderedOrRefused) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        if (!c.error.empty()) {
            if (GetParam() != "cpu") continue;  // refused before any backend is created
            try {
                render(c, GetParam());
                ADD_FAILURE() << "rendered without an error that says " << c.error;
            } catch (const InputError& error) {
                const std::string what = error.what();
                EXPECT_NE(what.find(c.error), std::string::npos) << what;
                EXPECT_TRUE(what.starts_with("test.pbrt:")) << "the error has no place:\n" << what;
            }
            continue;
        }
        Rendered rendered;
        try {
            rendered = render(c, GetParam());
        } catch (const Error& error) {
            ADD_FAILURE() << error.what();
            continue;
        }
        EXPECT_EQ(rendered.summary.non_finite, 0u);
        EXPECT_EQ(rendered.summary.samples, 8u * 8u * 4u);
        bool finite = true, lit = false;
        for (const float value : rendered.image.rgb().pixels) {
            finite = finite && std::isfinite(value);
            lit = lit || value > 0.0f;
        }
        EXPECT_TRUE(finite);
        if (c.expect != Expect::kFinite) {
            EXPECT_EQ(lit, c.expect == Expect::kLit);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Backends, Degenerate, testing::ValuesIn(usable_backends()), [](const auto& info) {
    std::string name = info.param;
    std::erase(name, '-');
    return name;
});

// 100,000 vertices in a white furnace of radiance 1 add up to 100,001, unless the driver ended the loop early (Mesa 22 does
// after 65,535 iterations), which is then reported.
TEST_P(Degenerate, AVeryLongPathIsWholeOrAnError) {
    RenderSettings settings;
    settings.backend = GetParam();
    settings.samples = 1;
    settings.integrator = "path:maxdepth=100000,rrdepth=100000";
    try {
        const Rendered room = render_text(
            "Camera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nWorldBegin\n"
            "ReverseOrientation\nAreaLightSource \"diffuse\"\n"
            "Material \"diffuse\" \"rgb reflectance\" [ 1 1 1 ]\n" +
                kSphere,
            settings);
        EXPECT_NEAR(room.value(0, 0, 1), 100001.0f, 10.0f);  // 10^5 products, each rounded, are off by about 2e-5
    } catch (const MachineError& error) {
        EXPECT_NE(std::string(error.what()).find("could not finish a loop"), std::string::npos) << error.what();
        EXPECT_EQ(GetParam(), "vulkan") << "no driver ends loops here";
    }
}

// Scenes that need more memory than there is are refused before it is allocated.
TEST(DegenerateMemory, AHugeFilmIsRefused) {
    Case c{"a huge film", kSky};
    c.film = "Film \"rgb\" \"integer xresolution\" 32768 \"integer yresolution\" 32768\n";
    if (machine_memory() > uint64_t(32768) * 32768 * 2 * sizeof(kernel::FilmPixel))
        GTEST_SKIP() << "it may fit into this machine";
    try {
        render(c, "cpu");
        FAIL() << "2^30 pixels fit into memory";
    } catch (const MachineError& error) {
        EXPECT_NE(std::string(error.what()).find("a film of 32768x32768 pixels needs"), std::string::npos)
            << error.what();
    }
}

}  // namespace
}  // namespace lampyris::test

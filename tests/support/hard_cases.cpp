#include "support/hard_cases.h"

#include "core/image/image_io.h"

#include <fmt/format.h>
#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lampyris::test {
namespace {

constexpr double kPi = std::numbers::pi;
const std::vector<std::string> kAll{"path", "bdpt", "vcm", "mlt", "sppm"};
const std::vector<std::string> kPhotons{"sppm"};

// Looks down at a square of the plane y = 0 with the given half width, from below all lamps, and with the pixels' sides `pixels`.
std::string view(double half, double height, const std::string& pixels = "8 8") {
    const size_t space = pixels.find(' ');
    return fmt::format(
        "LookAt 0 {0} 0  0 0 0  0 0 1\nCamera \"orthographic\" \"float screenwindow\" [ -{1} {1} -{1} {1} ]\n"
        "Film \"rgb\" \"integer xresolution\" {2} \"integer yresolution\" {3}\n"
        "PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\nSampler \"independent\"\nWorldBegin\n",
        height, half, pixels.substr(0, space), pixels.substr(space + 1));
}

std::string sky(double radiance) {
    return fmt::format("LightSource \"infinite\" \"rgb L\" [ {0} {0} {0} ]\n", radiance);
}

std::string diffuse(double reflectance) {
    return fmt::format("Material \"diffuse\" \"rgb reflectance\" [ {0} {0} {0} ]\n", reflectance);
}

std::string floor(double half) {
    return fmt::format(
        "Shape \"trianglemesh\" \"point3 P\" [ -{0} 0 -{0} -{0} 0 {0} {0} 0 {0} {0} 0 -{0} ] \"integer indices\" "
        "[ 0 1 2 0 2 3 ]\n",
        half);
}

std::string point(double intensity, double height) {
    return fmt::format("LightSource \"point\" \"rgb I\" [ {0:.9g} {0:.9g} {0:.9g} ] \"point3 from\" [ 0 {1} 0 ]\n",
                       intensity, height);
}

// A spherical lamp above the origin.
std::string lamp(double radius, double height, double radiance) {
    return fmt::format(
        "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ {2:.9g} {2:.9g} {2:.9g} ]\nTranslate 0 {1:.9g} 0 Shape "
        "\"sphere\" \"float radius\" {0:.9g} AttributeEnd\n",
        radius, height, radiance);
}

// A sky of 1 whose four texels around the zenith (y) have the given radiance; size x size texels.
std::string bright_zenith(double radiance, int size) {
    Image sky(size, size, {"R", "G", "B"});
    std::fill(sky.pixels.begin(), sky.pixels.end(), 1.0f);
    for (int y = size / 2 - 1; y <= size / 2; ++y)
        for (int x = size / 2 - 1; x <= size / 2; ++x)
            for (int c = 0; c < 3; ++c) sky.at(x, y, c) = float(radiance);
    const std::string file = LAMPYRIS_BINARY_DIR "/bright_zenith.exr";
    write_image(file, sky);
    return "AttributeBegin Rotate -90 1 0 0 LightSource \"infinite\" \"string filename\" \"" + file +
           "\" AttributeEnd\n";
}

// On the equal-area octahedral square [-1, 1]^2, an area of 1 is a solid angle of pi, and the cosine to the pole at (u, v) is
// 1 - (|u| + |v|)^2 (Clarberg 2008, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD"). Integrated over [-h, h]^2.
double bright_zenith_irradiance(double radiance, int size) {
    const double h = 2.0 / size;
    return kPi + kPi * (radiance - 1) * (4 * h * h - 14 * h * h * h * h / 3);
}

// The mean irradiance on the square [-half, half]^2 of a point source is its intensity times the square's solid angle over its
// area.
double mean_irradiance(double intensity, double height, double half) {
    const double angle = 4.0 * std::atan(half * half / (height * std::sqrt(height * height + 2.0 * half * half)));
    return intensity * angle / (4.0 * half * half);
}

// Corners of a box, and its triangles with the first corner's number.
std::string box_corners(const glm::dvec3& low, const glm::dvec3& high) {
    std::string corners;
    for (const double y : {low.y, high.y})
        corners += fmt::format(
            " {0:.9g} {2:.9g} {3:.9g} {1:.9g} {2:.9g} {3:.9g} {1:.9g} {2:.9g} {4:.9g} {0:.9g} {2:.9g} {4:.9g}", low.x,
            high.x, y, low.z, high.z);
    return corners;
}
std::string slab_triangles(int first) {
    std::string all;
    for (const int corner :
         {0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6, 0, 5, 1, 0, 4, 5, 1, 6, 2, 1, 5, 6, 2, 7, 3, 2, 6, 7, 3, 4, 0, 3, 7, 4})
        all += fmt::format(" {}", first + corner);
    return all;
}
std::string mesh(const std::string& corners, const std::string& triangles) {
    return "Shape \"trianglemesh\" \"point3 P\" [" + corners + " ] \"integer indices\" [" + triangles + " ]\n";
}

std::string slab(double low, double high) { return mesh(box_corners({-2, low, -2}, {2, high, 2}), slab_triangles(0)); }

// Below and above the height 1.
std::string two_slabs() {
    return mesh(box_corners({-2, 0, -2}, {2, 1, 2}) + box_corners({-2, 1, -2}, {2, 2, 2}),
                slab_triangles(0) + slab_triangles(8));
}

// A square [-1, 1]^2 of needles that meet in one corner: their angles are 3e-3 and less.
std::string needles(int count) {
    std::string points = "-1 0 -1", indices;
    const auto add = [&](double x, double z) { points += fmt::format("  {:.9g} 0 {:.9g}", x, z); };
    for (int i = 0; i <= count; ++i) add(1.0, -1.0 + 2.0 * i / count);
    for (int i = 1; i <= count; ++i) add(1.0 - 2.0 * i / count, 1.0);
    for (int i = 1; i <= 2 * count; ++i) indices += fmt::format(" 0 {} {}", i + 1, i);
    return "Shape \"trianglemesh\" \"point3 P\" [ " + points + " ] \"integer indices\" [" + indices + " ]\n";
}

// A grid of squares whose vertices are the centres of the pixels of view(1, ..., "8 8").
std::string grid() {
    std::string points, indices;
    for (int z = 0; z < 10; ++z)
        for (int x = 0; x < 10; ++x) points += fmt::format(" {} 0 {}", (x - 4.5) / 4.0, (z - 4.5) / 4.0);
    for (int z = 0; z < 9; ++z)
        for (int x = 0; x < 9; ++x) {
            const int a = 10 * z + x;
            indices += fmt::format(" {} {} {} {} {} {}", a, a + 10, a + 11, a, a + 11, a + 1);
        }
    return "Shape \"trianglemesh\" \"point3 P\" [" + points + " ] \"integer indices\" [" + indices + " ]\n";
}

std::string glass(double eta) { return fmt::format("Material \"dielectric\" \"float eta\" {:.9g}\n", eta); }

std::vector<HardCase> make_cases() {
    std::vector<HardCase> cases;
    // Under a sky of 1, what loses no light shows 1.
    const auto in_furnace = [&](const std::string& name, const std::string& material, double tolerance,
                                const std::string& settings = "maxdepth=5", uint32_t samples = 16) {
        cases.push_back({name, view(0.7, 3) + sky(1) + material + "Shape \"sphere\" \"float radius\" 1\n", 1.0,
                         tolerance, samples, settings, kAll});
    };
    in_furnace("an albedo of exactly 1", diffuse(1), 1e-5, "maxdepth=5", 64);
    for (const double eta : {1.000001, 1.5, 4.0})
        in_furnace(fmt::format("glass of index {}", eta), glass(eta), 1e-4, "maxdepth=100,rrdepth=100");
    in_furnace(
        "a mirror of roughness 1e-4",
        "Material \"conductor\" \"rgb reflectance\" [ 1 1 1 ] \"float roughness\" 1e-4 \"bool remaproughness\" false\n",
        1e-3);
    for (const double gap : {0.0, 1e-6, 1e-3})
        cases.push_back({fmt::format("two slabs of glass, {} apart", gap),
                         view(0.7, 5) + sky(1) + glass(1.5) + slab(0, 1) + slab(1 + gap, 2),
                         1.0,
                         1e-4,
                         16,
                         "maxdepth=100,rrdepth=100",
                         {"path", "bdpt", "vcm", "sppm"}});
    cases.push_back({"a slab of glass that lies on a floor of albedo 1",
                     view(0.7, 5) + sky(1) + glass(1.5) + slab(0, 1) + diffuse(1) + floor(3),
                     1.0,
                     1e-4,
                     16,
                     "maxdepth=100,rrdepth=100",
                     {"path", "bdpt"}});
    // The same where the surfaces are in one mesh, or on a disk, or in instances of objects.
    const auto lies = [&](const std::string& name, const std::string& world) {
        cases.push_back(
            {name, view(0.7, 5) + sky(1) + world, 1.0, 1e-4, 16, "maxdepth=100,rrdepth=100", {"path", "bdpt"}});
    };
    lies("two slabs in one mesh, face on face", glass(1.5) + two_slabs());
    lies("a slab of glass on a disk of albedo 1",
         glass(1.5) + slab(0, 1) + diffuse(1) + "Rotate -90 1 0 0 Shape \"disk\" \"float radius\" 4\n");
    lies("a slab of glass that is an instance, on a floor of albedo 1 and on another one",
         "ObjectBegin \"slab\"\n" + glass(1.5) + slab(0, 1) + "ObjectEnd\n" + diffuse(1) + floor(3) +
             "ObjectInstance \"slab\" Translate 0 1 0 ObjectInstance \"slab\"\n");
    // Scales of 10^6 in one picture, far from the origin.
    for (const int x : {0, 100}) {
        std::string text = view(0.001, 0.002);
        text.replace(0, text.find("Camera"), fmt::format("LookAt {0} 0.002 0  {0} 0 0  0 0 1\n", x));
        cases.push_back({fmt::format("a ball of glass of 1 mm above a floor of 1 km, {} m from its centre", x),
                         text + sky(1) + diffuse(1) + floor(500) + glass(1.5) +
                             fmt::format("Translate {} 0.00075 0 Shape \"sphere\" \"float radius\" 0.0005\n", x),
                         1.0,
                         1e-3,
                         64,
                         "maxdepth=100,rrdepth=100",
                         {"path"}});
    }
    // Found by a thousand random scenes. Planes of long triangles that are turned are known less well than their corners; a face that
    // is lifted from the floor must not push its neighbours into the next body; and rays are rounded where an object was defined.
    const auto touch = [&](const std::string& name, const std::string& world, double tolerance) {
        const std::string from = "LookAt 3.5 -4 3  1 .5 .5  0 0 1\nCamera \"perspective\" \"float fov\" 40\n";
        const std::string rest = view(1, 1);
        cases.push_back({name,
                         from + rest.substr(rest.find("Film")) + sky(1) + glass(1.5) + world,
                         1.0,
                         tolerance,
                         16,
                         "maxdepth=1000,rrdepth=1000",
                         {"path"}});
    };
    touch("two rods of glass, turned, side by side",
          "Rotate 49.1221147 -0.311670798 0.556988783 0.769821284 Scale 2.10518867 -0.711837401 0.524583952\n" +
              mesh(box_corners({0.22, 0.18, 0.83}, {2.22, 0.76, 1.32}), slab_triangles(0)) +
              mesh(box_corners({-0.18, 0.08, 1.32}, {1.82, 0.82, 2.52}), slab_triangles(0)),
          1e-4);
    const std::string tetrahedron = " 0 2 1 0 1 3 1 2 3 2 0 3";
    touch("a tetrahedron of glass that leans on another one, which stands on a mirror",
          mesh(" 0 0 0 1 0 0 0 1 0 0.3 0.3 1", tetrahedron) + mesh(" 1 0 0 0 1 0 0.3 0.3 1 1 1 0.5", tetrahedron) +
              "Material \"conductor\" \"rgb reflectance\" [ 1 1 1 ] \"float roughness\" 0\n" +
              mesh(" -4 -4 0 4 -4 0 4 4 0 -4 4 0", " 0 1 2 0 2 3"),
          5e-4);  // mirrors reflect .9999
    touch("a box of glass beside an instance of one far from its origin",
          "ObjectBegin \"box\"\n" + mesh(box_corners({16, 16, 16}, {17, 17, 17}), slab_triangles(0)) + "ObjectEnd\n" +
              mesh(box_corners({1, 0, 0}, {2, 0.6, 1.3}), slab_triangles(0)) +
              "Translate -16 -16 -16 ObjectInstance \"box\"\n",
          1e-4);
    // A rod of glass whose far end shines: all light is reflected totally, up to 170 times. Of 250 lengths of paths, mlt tries each
    // rarely.
    cases.push_back(
        {"170 total reflections",
         "LookAt 0 0 0  0 0 1  0 1 0\nCamera \"perspective\" \"float fov\" 80\nFilm \"rgb\" \"integer xresolution\" 8 "
         "\"integer yresolution\" 8\nPixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\n"
         "Sampler \"independent\"\nWorldBegin\n" +
             std::string("AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ] Material \"diffuse\" \"rgb "
                         "reflectance\" [ 0 0 0 ] Shape \"trianglemesh\" \"point3 P\" [ "
                         "-1.5 -1.5 199 -1.5 1.5 199 1.5 1.5 199 1.5 -1.5 199 ] \"integer indices\" [ 0 1 2 0 2 3 ] "
                         "AttributeEnd\n") +
             glass(1.5) +
             "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 -1 1 -1 -1 1 1 -1 -1 1 -1 -1 -1 200 1 -1 200 1 1 200 -1 1 "
             "200 ] "
             "\"integer indices\" [ 0 2 1 0 3 2  4 5 6 4 6 7  0 1 5 0 5 4  1 2 6 1 6 5  2 3 7 2 7 6  3 0 4 3 4 7 ]\n",
         1.0,
         1e-4,
         16,
         "maxdepth=250,rrdepth=250",
         {"path", "bdpt", "vcm", "sppm"}});
    // A floor of reflectance 0.5 under lamps: radiance is 0.5 / pi times the irradiance.
    const auto under = [&](const std::string& name, const std::string& lamps, double irradiance, double tolerance,
                           double half = 1, uint32_t samples = 64, double extent = 0) {
        cases.push_back({name, view(half, 0.5 * half) + lamps + diffuse(0.5) + floor(extent > 0 ? extent : half),
                         0.5 / kPi * irradiance, tolerance, samples, "maxdepth=1", kAll});
    };
    const double mean = mean_irradiance(1, 1, 1);
    under("a lamp of 1e-5 of the floor", lamp(1e-5, 1, 1e10 / kPi), mean, 1e-4);
    for (const double height : {1.0, 100.0, 1e4})
        under(fmt::format("a lamp of 1e6 times the floor, {} above", height), lamp(1e6, 1e6 + height, 1),
              kPi / ((1 + 1e-6 * height) * (1 + 1e-6 * height)), 1e-3);
    under("a lamp of 1 mm in a scene of 1 km", lamp(5e-4, 1, 1 / (kPi * 25e-8)), mean, 1e-4, 1, 64, 500);
    // vcm's radius is a share of the scene's, and larger than what the camera sees.
    cases.back().integrators = {"path", "bdpt", "mlt", "sppm"};
    under("a lamp of no power beside another", lamp(0.1, 2, 0) + point(0, 3) + point(1, 1), mean, 1e-4);
    for (const double degrees : {0.5, 1e-4}) {
        const double half_angle = degrees / 2 * kPi / 180, sine = std::sin(half_angle);
        under(fmt::format("a sun of {} degrees", degrees), lamp(1000 * sine, 1000, 1 / (sine * sine)), kPi, 1e-4);
    }
    // Four texels around the zenith; a texel has 4 pi / 32^2 of solid angle.
    under("a map of the sky with texels of 1e9", bright_zenith(1e9, 32), bright_zenith_irradiance(1e9, 32), 1e-4);
    // Cosines of narrow beams are 1 as floats; and splats are large where a beam meets little of a large scene. The picture shows
    // what is within the beam, or all of it.
    for (const auto& [degrees, reach] : {std::pair{0.01, 0}, {0.001, 0}, {0.01, 100000}})
        for (const bool whole : {false, true}) {
            const double radius = std::tan(degrees * kPi / 180), half = (whole ? 2 : 0.6) * radius;
            std::string text = fmt::format(
                "LightSource \"spot\" \"rgb I\" [ 1 1 1 ] \"point3 from\" [ 0 1 0 ] \"point3 to\" [ 0 0 0 ] \"float "
                "coneangle\" {} "
                "\"float conedeltaangle\" 0\n",
                degrees);
            for (const int x : {-reach, reach})
                if (x != 0) text += fmt::format("AttributeBegin Translate {} 0 0 Shape \"sphere\" AttributeEnd\n", x);
            under(fmt::format("{} a beam of {} degrees{}", whole ? "all of" : "within", degrees,
                              reach > 0 ? " in a scene of 100 km" : ""),
                  text, whole ? kPi * radius * radius / (4 * half * half) : 1.0, 1e-2, half, 256, 1);
            // vcm's radius: as above.
            cases.back().integrators = {"path", "light", "bdpt", "mlt", "sppm"};
        }
    std::string many;
    for (int i = 0; i < 100000; ++i) many += point(1e-5, 1);
    under("100,000 lamps", many, mean, 1e-4);
    under("a lamp 1e12 times as bright as another", point(1e-6, 0.6) + point(1e6, 1), 1e6 * mean, 1e-4);
    // Floors under a sky of 1 show their reflectance; where one leaks, the sky.
    const auto whole = [&](const std::string& name, const std::string& text, double tolerance) {
        cases.push_back({name, text, 0.5, tolerance, 64, "maxdepth=2", kAll});
    };
    whole("needles with angles of 3e-3", view(0.95, 1) + sky(1) + diffuse(0.5) + needles(300), 1e-5);
    cases.back().samples = 16, cases.back().power = 0.1;  // rays meet hundreds of boxes
    std::string centres = view(1, 1);
    centres.replace(centres.find("0.5 \"float yradius\" 0.5"), 23, "1e-5 \"float yradius\" 1e-5");
    whole("rays through vertices", centres + sky(1) + diffuse(0.5) + grid(), 1e-5);
    for (const double angle : {2e-6, 1e-7, 2e-8})
        whole(fmt::format("a grazing angle of {}", angle),
              fmt::format(
                  "LookAt 0 {} 0  1000 0 0  0 1 0\nCamera \"orthographic\" \"float screenwindow\" [ -1 1 -{} {} ]\n",
                  1000 * angle, 100 * angle, 100 * angle) +
                  "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nPixelFilter \"box\" \"float "
                  "xradius\" "
                  "0.5 \"float yradius\" 0.5\nSampler \"independent\"\nWorldBegin\n" +
                  sky(1) + diffuse(0.5) + floor(2000),
              1e-5);
    for (const std::string pixels : {"1 1", "16384 1", "1 16384"}) {
        std::string film = view(0.7, 3, pixels);
        whole("a film of " + pixels, film + sky(1) + diffuse(0.5) + "Shape \"sphere\" \"float radius\" 1\n", 1e-5);
        if (pixels == "1 1") cases.back().samples = 256, cases.back().power = 0.2;
        if (pixels != "1 1") cases.back().samples = 1, cases.back().integrators = {"path", "bdpt", "vcm", "sppm"};
    }
    // Photons alone: `direct=photons` has no light samples.
    const auto by_photons = [&](const std::string& name, const std::string& lamps, double irradiance, double tolerance,
                                const std::string& settings, uint32_t passes) {
        cases.push_back({name, view(1, 0.5) + lamps + diffuse(0.5) + floor(3), 0.5 / kPi * irradiance, tolerance,
                         passes, "maxdepth=1,direct=photons," + settings, kPhotons});
    };
    by_photons("one photon a pass", point(1, 1), mean, 0.01, "radius=0.05,photonsperiteration=1", 6000);
    cases.back().power = 0.4;
    const std::string disk =
        "AttributeBegin Translate 0 {} 0 Rotate {} 1 0 0 AreaLightSource \"diffuse\" \"rgb L\" [ 1e8 1e8 1e8 ] Shape "
        "\"disk\" "
        "\"float radius\" 1e-4 AttributeEnd\n";
    by_photons("all photons in one cell", fmt::format(fmt::runtime(disk), 1e-4, 90), kPi * kPi / 4, 0.01,
               "radius=0.5,alpha=1,photonsperiteration=5000", 32);
    cases.back().power = 0.15;
    const HardCase one_cell = cases.back();
    for (const std::string& map : photon_maps().names()) {
        cases.push_back(one_cell);
        cases.back().name += ", " + map;
        cases.back().photon_map = map;
        if (map != "stochastic_hash") cases.back().samples = 16;  // stochastic hashing needs all for its power
    }
    by_photons("no photon at all", fmt::format(fmt::runtime(disk), 1e-4, -90), 0, 0,
               "radius=0.05,photonsperiteration=1000", 16);
    for (HardCase& hard : cases)
        for (const char* name :
             {"slab", "of glass", "total", "floor, 1 above", "1 mm", "needles", "vertices", "grazing", "film"})
            hard.for_tracers |= hard.name.find(name) != std::string::npos;
    for (HardCase& hard : cases)
        for (const char* name :
             {"glass, 0 apart", "an instance of one", "needles", "grazing angle of 2e-08", "100 m from"})
            hard.for_vulkan |= hard.name.find(name) != std::string::npos;
    return cases;
}

}  // namespace

const std::vector<HardCase>& hard_cases() {
    static const std::vector<HardCase> cases = make_cases();
    return cases;
}

Measured measure_case(const HardCase& hard, const std::string& integrator, const std::string& backend) {
    RenderSettings settings;
    settings.backend = backend;
    settings.samples = hard.samples;
    settings.integrator = integrator + ":" + hard.settings;
    if (!hard.photon_map.empty()) settings.photon_map = hard.photon_map;
    if (integrator == "mlt") {
        // A pass is eight mutations a pixel, and a bootstrap, whose default is for larger films.
        settings.samples = std::clamp(hard.samples / 2, 8u, 64u);
        // There is no roulette, and a path has one number per dimension.
        const size_t roulette = settings.integrator.find(",rrdepth");
        if (roulette != std::string::npos) settings.integrator.resize(roulette);
        settings.integrator += ",bootstrapsamples=8192";
    }
    settings.share_device = true;
    Measured measured{0, 0, 0};
    std::vector<double> means;
    for (const Rendered& image : render_text_seeds(hard.scene, settings, kSeeds)) {
        means.push_back(image.mean_luminance());
        measured.non_finite += image.summary.non_finite;
    }
    for (const double mean : means) measured.mean += mean / kSeeds;
    double squares = 0.0;
    for (const double mean : means) squares += (mean - measured.mean) * (mean - measured.mean);
    measured.standard_error = std::sqrt(squares / (kSeeds - 1) / kSeeds);
    return measured;
}

void expect_case(const HardCase& hard, const std::string& integrator, const std::string& backend) {
    const Measured measured = measure_case(hard, integrator, backend);
    const double error = measured.mean - hard.radiance;
    fmt::print("{} | {} | {} | {:.6g} | {:.6g} | {:+.1e} | {:.1e}\n", hard.name, integrator, backend, hard.radiance,
               measured.mean, error / std::max(hard.radiance, 1e-30),
               measured.standard_error / std::max(hard.radiance, 1e-30));
    EXPECT_EQ(measured.non_finite, 0u) << hard.name << ", " << integrator << " on " << backend;
    EXPECT_LE(std::abs(error), hard.tolerance * hard.radiance + kErrors * measured.standard_error)
        << hard.name << ", " << integrator << " on " << backend << ": " << measured.mean << " +- "
        << measured.standard_error << ", not " << hard.radiance;
    // What the comparison can show.
    EXPECT_LE(kErrors * measured.standard_error, hard.power * hard.radiance + 1e-30) << hard.name << ", " << integrator;
}

}  // namespace lampyris::test

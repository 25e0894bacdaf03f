#include "support/random_scene.h"

#include <fmt/format.h>

#include <random>
#include <vector>

namespace lampyris::test {
namespace {

class Generator {
 public:
    Generator(uint32_t seed, bool smooth) : random_(seed), smooth_(smooth) {}

    std::string scene() {
        std::string text = fmt::format(
            "LookAt {} {} {}  {} {} {}  0 1 0\nCamera \"perspective\" \"float fov\" {}\n"
            "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 12\nSampler \"independent\"\nWorldBegin\n",
            between(-4, 4), between(0.5, 3), between(-6, -4), between(-0.5, 0.5), between(0, 1), between(-0.5, 0.5),
            between(30, 70));
        if (chance(0.5)) text += fmt::format("LightSource \"infinite\" \"rgb L\" [ {} ]\n", rgb(0.1, 0.8));
        for (int i = below(2); i >= 0; --i) text += lamp();
        if (smooth_ && chance(0.5))
            text += fmt::format("LightSource \"point\" \"rgb I\" [ {} ] \"point3 from\" [ {} 3 {} ]\n", rgb(2, 9),
                                between(-2, 2), between(-2, 2));
        if (chance(0.3))
            text += fmt::format("LightSource \"distant\" \"rgb L\" [ {} ] \"point3 from\" [ {} 4 {} ]\n", rgb(0.2, 1),
                                between(-2, 2), between(-2, 2));
        text += diffuse() +
                "Shape \"trianglemesh\" \"point3 P\" [ -5 -.6 -5 -5 -.6 5 5 -.6 5 5 -.6 -5 ] \"integer indices\" [ 0 1 "
                "2 0 2 3 ]\n";
        for (int i = 2 + below(4); i > 0; --i)
            text += "AttributeBegin\n" + material() +
                    placed(between(-1.8, 1.8), between(-0.3, 1.5), between(-1.8, 1.8)) + shape() + "AttributeEnd\n";
        return text;
    }

 private:
    double between(double low, double high) { return low + (high - low) * double(random_()) / 4294967296.0; }
    int below(int n) { return int(random_() % uint32_t(n)); }
    bool chance(double p) { return between(0, 1) < p; }
    std::string rgb(double low, double high) {
        const double r = between(low, high), g = between(low, high), b = between(low, high);
        return fmt::format("{:.4f} {:.4f} {:.4f}", r, g, b);
    }
    std::string placed(double x, double y, double z) {
        const double angle = between(0, 360), a = between(-1, 1), b = between(-1, 1);
        const double sx = between(0.5, 1.6), sy = between(0.5, 1.6), sz = between(0.5, 1.6);
        return fmt::format(
            "Translate {:.4f} {:.4f} {:.4f} Rotate {:.3f} {:.3f} {:.3f} 0.5 Scale {:.3f} {:.3f} {:.3f}\n", x, y, z,
            angle, a, b, chance(0.2) ? -sx : sx, sy, sz);
    }
    std::string shape() {
        switch (below(5)) {
            case 0: return "Shape \"sphere\" \"float radius\" 0.5\n";
            case 1: return "Shape \"cylinder\" \"float radius\" 0.3 \"float zmin\" -0.5 \"float zmax\" 0.5\n";
            case 2: return "Shape \"disk\" \"float radius\" 0.6\n";
            case 3: return "Shape \"bilinearmesh\" \"point3 P\" [ -.6 0 -.6 .6 .2 -.5 -.5 .3 .6 .5 -.1 .5 ]\n";
            default:
                return "Shape \"trianglemesh\" \"point3 P\" [ -.5 -.4 -.4 .5 -.4 -.4 0 -.4 .5 0 .5 0 ] \"integer "
                       "indices\" "
                       "[ 0 1 2 0 3 1 1 3 2 2 3 0 ]\n";
        }
    }
    std::string diffuse() { return fmt::format("Material \"diffuse\" \"rgb reflectance\" [ {} ]\n", rgb(0.1, 0.9)); }
    std::string material() {
        const double rough = between(smooth_ ? 0.05 : 0.3, 0.8);
        switch (below(smooth_ ? 8 : 4)) {
            case 0: return diffuse();
            case 1:
                return fmt::format(
                    "Material \"conductor\" \"rgb reflectance\" [ {} ] \"float roughness\" {:.3f} \"bool "
                    "remaproughness\" "
                    "false\n",
                    rgb(0.3, 0.95), rough);
            case 2:
                return fmt::format(
                    "Material \"diffusetransmission\" \"rgb reflectance\" [ {} ] \"rgb transmittance\" [ {} ]\n",
                    rgb(0.1, 0.4), rgb(0.1, 0.5));
            case 3:
                return fmt::format(
                    "Material \"coateddiffuse\" \"rgb reflectance\" [ {} ] \"float roughness\" {:.3f} \"bool "
                    "remaproughness\" false\n",
                    rgb(0.1, 0.9), rough);
            case 4: return fmt::format("Material \"dielectric\" \"float eta\" {:.3f}\n", between(1.05, 2.2));
            case 5:
                return fmt::format("Material \"dielectric\" \"float eta\" {:.3f} \"float roughness\" {:.3f}\n",
                                   between(1.1, 2), rough);
            case 6: return "Material \"thindielectric\"\n";
            default:
                return fmt::format("Material \"conductor\" \"rgb reflectance\" [ {} ] \"float roughness\" 0\n",
                                   rgb(0.5, 1));
        }
    }
    std::string lamp() {
        return fmt::format("AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ {} ] \"bool twosided\" true\n",
                           rgb(1, 6)) +
               placed(between(-2, 2), between(2, 3.5), between(-2, 2)) + shape() + "AttributeEnd\n";
    }

    std::mt19937 random_;
    bool smooth_;
};

}  // namespace

std::string random_scene(uint32_t seed, bool smooth) { return Generator(seed, smooth).scene(); }

}  // namespace lampyris::test

// Loading time is proportional to the size of a scene, even if it repeats some statement many times. Ten times the statements
// may take 25 times the processor time: data that no longer fit the caches cause up to 18, quadratic behaviour nearly 100. A
// measurement that another program disturbs is repeated, so that a false alarm needs three wrong ones in a row.
#include "core/device/device.h"
#include "support/build_text.h"
#include "support/render.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <time.h>

#include <algorithm>
#include <fstream>
#include <functional>

namespace lampyris::test {
namespace {

struct Kind {
    const char* name;
    std::function<std::string(int)> world;           // of so many statements
    int statements = 20000;                          // of the larger scene
    size_t errors = 0;                               // told of either: all scenes have more
    std::function<size_t(const Scene&)> count = {};  // of what the statements make
};

std::string repeat(int n, const std::function<std::string(int)>& one) {
    std::string text;
    for (int i = 0; i < n; ++i) text += one(i);
    return text;
}

// A statement at a different location each time.
std::string at(int i, const std::string& body) {
    return fmt::format("AttributeBegin\nTranslate {} {} {}\n{}\nAttributeEnd\n", i % 100, i / 100 % 100, i / 10000,
                       body);
}

const std::string kBall = "Shape \"sphere\" \"float radius\" 0.1\n";

size_t geometries(const Scene& scene) { return scene.geometries.size(); }
size_t instances(const Scene& scene) { return scene.instances.size() - 1; }
size_t lights(const Scene& scene) { return scene.lights.size(); }
size_t materials(const Scene& scene) { return scene.materials.size(); }

Kind of_instances() {
    return {"instances",
            [](int n) {
                return "ObjectBegin \"o\"\n" + kBall + "ObjectEnd\n" +
                       repeat(n, [](int i) { return at(i, "ObjectInstance \"o\""); });
            },
            20000, 0, instances};
}
Kind of_shapes() {
    return {"shapes", [](int n) { return repeat(n, [](int i) { return at(i, kBall); }); }, 20000, 0, geometries};
}
Kind of_objects() {
    return {"objects",
            [](int n) {
                return repeat(n, [](int i) {
                    return fmt::format("ObjectBegin \"o{}\"\n{}ObjectEnd\n", i, kBall) +
                           at(i, fmt::format("ObjectInstance \"o{}\"", i));
                });
            },
            5000, 0, instances};
}

std::vector<Kind> kinds() {
    const auto numbered = [](const char* form) {
        return [form](int n) {
            return repeat(n, [&](int i) { return fmt::format(fmt::runtime(form), i, i % 2 ? 0.25 : 0.75) + kBall; });
        };
    };
    return {
        of_instances(),
        of_shapes(),
        of_objects(),
        {"shapes of an object",
         [](int n) { return "ObjectBegin \"o\"\n" + of_shapes().world(n) + "ObjectEnd\nObjectInstance \"o\"\n"; },
         20000, 0, geometries},
        {"objects without instances",
         [](int n) {
             return repeat(n, [](int i) { return fmt::format("ObjectBegin \"o{}\"\n{}ObjectEnd\n", i, kBall); });
         }},
        {"lights",
         [](int n) { return repeat(n, [](int i) { return at(i, "LightSource \"point\" \"rgb I\" [ 1 2 3 ]"); }); },
         20000, 0, lights},
        {"emissive shapes", numbered("AreaLightSource \"diffuse\" \"float scale\" {1}\n"), 20000, 0, lights},
        {"materials", numbered("Material \"diffuse\" \"rgb reflectance\" [ {1} 0.5 0.5 ]\n"), 20000, 0, materials},
        {"named materials",
         numbered("MakeNamedMaterial \"m{0}\" \"string type\" \"diffuse\" \"rgb reflectance\" [ {1} 0.5 0.5 ]\n"
                  "NamedMaterial \"m{0}\"\n"),
         20000, 0, materials},
        {"mixes",
         [&](int n) {
             return "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n" +
                    numbered(
                        "MakeNamedMaterial \"m{0}\" \"string type\" \"mix\" \"float amount\" {1} \"string "
                        "materials\" [ \"a\" \"m{0}a\" ]\n"
                        "MakeNamedMaterial \"m{0}a\" \"string type\" \"diffuse\"\nNamedMaterial \"m{0}\"\n")(n);
         }},
        {"textures",
         numbered("Texture \"t{0}\" \"spectrum\" \"constant\" \"rgb value\" [ {1} 0.5 0.5 ]\n"
                  "Material \"diffuse\" \"texture reflectance\" \"t{0}\"\n"),
         20000, 0, materials},
        {"media",
         numbered(
             "MakeNamedMedium \"m{0}\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ 0 0 0 ] \"rgb sigma_a\" [ 1 1 "
             "{1} ]\nMediumInterface \"m{0}\" \"\"\n"),
         20000},
        {"open blocks",
         [](int n) {
             return repeat(n, [](int) { return std::string("AttributeBegin\nTranslate 0 0 1\n"); }) + kBall +
                    repeat(n, [](int) { return std::string("AttributeEnd\n"); });
         }},
        {"blocks that do not match",
         [](int n) {
             return repeat(n, [](int) { return std::string("AttributeBegin\n"); }) +
                    repeat(n, [](int) { return std::string("ObjectEnd\n"); });
         },
         20000, 20},
        {"unknown shapes", numbered("Shape \"shere\" \"float radius\" {1}\n"), 20000, 20},
        {"unknown parameters", numbered("Shape \"sphere\" \"float radus\" {1}\n"), 20000, 20},
        {"names that nobody defines",
         numbered("MakeNamedMaterial \"material{0}\" \"string type\" \"diffuse\"\nNamedMaterial \"materials{0}\"\n"),
         20000, 20},
        {"textures that nobody defines",
         numbered(
             "Texture \"t{0}\" \"spectrum\" \"constant\"\nMaterial \"diffuse\" \"texture reflectance\" \"s{0}\"\n"),
         20000, 20},
        {"files that are not there", numbered("Shape \"plymesh\" \"string filename\" \"nothing{0}.ply\"\n"), 20000, 20},
        {"values out of range", numbered("Shape \"sphere\" \"float radius\" -{1}\n"), 20000, 20},
        {"warnings",
         [](int n) {
             return "Material \"interface\"\nAreaLightSource \"diffuse\"\n" +
                    repeat(n, [](int i) { return at(i, kBall); });
         },
         20000, 0, geometries},
    };
}

double thread_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

void expect_proportion(const std::string& what, const std::function<double(int)>& seconds_of, int statements) {
    double small = 0.0, large = 0.0;
    for (int attempt = 0; attempt < 3; ++attempt) {
        small = seconds_of(statements / 10);
        large = seconds_of(statements);
        if (large <= 25.0 * small) return;
    }
    ADD_FAILURE() << what << ": " << statements / 10 << " take " << small << " s, " << statements << " take " << large;
}

class LoadingTime : public testing::TestWithParam<Kind> {};

TEST_P(LoadingTime, IsInProportion) {
    const Kind& kind = GetParam();
    const auto load = [&](int n) {
        const std::string world = kind.world(n);
        const double start = thread_seconds();
        const BuiltText text = build_world(world);
        const double seconds = thread_seconds() - start;
        EXPECT_EQ(text.errors.size(), kind.errors) << text.all_errors().substr(0, 1000);
        if (kind.count) {
            EXPECT_GE(kind.count(text.scene()), size_t(n));
            EXPECT_LE(kind.count(text.scene()), size_t(n) + 1);
        }
        EXPECT_LT(text.scene().notes.size(), 20u);
        return seconds;
    };
    expect_proportion(kind.name, load, kind.statements);
}

INSTANTIATE_TEST_SUITE_P(Kinds, LoadingTime, testing::ValuesIn(kinds()), [](const auto& info) {
    std::string name = info.param.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
});

// Many files, each of which changes a coordinate system while another thousand are known.
TEST(LoadingTimeOfFiles, IsInProportion) {
    const TemporaryFolder folder;
    const auto load = [&](int n) {
        std::string world = repeat(n, [](int i) { return fmt::format("CoordinateSystem \"c{}\"\n", i); });
        for (int i = 0; i < n; ++i) {
            const std::string name = fmt::format("part{}.pbrt", i);
            std::ofstream(folder / name) << at(i, "CoordinateSystem \"c0\"\n" + kBall);
            world += fmt::format("{} \"{}\"\n", i % 2 ? "Include" : "Import", name);
        }
        const double start = thread_seconds();
        const BuiltText text = build_text("Camera \"perspective\"\nWorldBegin\n" + world, false, {}, folder.string());
        const double seconds = thread_seconds() - start;
        EXPECT_EQ(text.all_errors().substr(0, 1000), "");
        EXPECT_EQ(geometries(text.scene()), size_t(n));
        return seconds;
    };
    expect_proportion("files", load, 5000);
}

// Setting the scene up on a device: acceleration structures and buffers.
class UploadTime : public testing::TestWithParam<std::string> {};

TEST_P(UploadTime, IsInProportion) {
    const std::unique_ptr<Device> device = create_device(GetParam(), DeviceOptions{});
    for (const Kind& kind : {of_instances(), of_shapes(), of_objects()}) {
        const auto upload = [&](int n) {
            const BuiltText text = build_world(kind.world(n));
            timespec time{};
            const auto process_seconds = [&] {
                clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
                return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
            };
            const double start = process_seconds();
            device->upload(text.scene());
            return process_seconds() - start;
        };
        expect_proportion(std::string(kind.name), upload, kind.statements);
    }
}

INSTANTIATE_TEST_SUITE_P(Backends, UploadTime, testing::ValuesIn(usable_backends()),
                         [](const auto& info) { return info.param == "cpu-bvh2" ? "cpu_bvh2" : info.param; });

}  // namespace
}  // namespace lampyris::test

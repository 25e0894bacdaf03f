// Runs `path` once over a small film on one thread, with the build that the program picks for the scene (registered), or with a
// build for exactly the scene's effects (exact; see effects_path.radiance.h). bench/effects.py counts instructions in both.
//
//     effects_bench SCENE WIDTHxHEIGHT SAMPLES registered|exact     prints JSON
#include "backends/cpu/cpu_scene.h"
#include "core/render/film.h"
#include "core/render/integrator.h"
#include "core/scene/load.h"
#include "integrators/path/path_params.h"

#include <nlohmann/json.hpp>
#include <xmmintrin.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

// callgrind measures between entering and leaving this function (--toggle-collect).
extern "C" __attribute__((noinline)) void lampyris_measured_kernel(lampyris::CpuKernelFunction kernel,
                                                                   const lampyris::CpuInvocation& call) {
    kernel(call);
}

namespace lampyris {
namespace {

int run(const std::string& file, int width, int height, uint32_t samples, bool exact) {
    BuildOptions options;
    options.resolution = {width, height};
    const LoadedScene loaded = load_scene(SceneSource::of_file(file), options, false);
    const Scene& scene = loaded.scene;
    const CpuScene cpu(scene, CpuTracerKind::embree, true);
    PathParams params;
    const IntegratorFactory& factory = integrators().require("path");
    set_defaults(&params, factory.fields);
    const char* kernel_file = exact ? "effects_path.radiance.h" : "integrators/path/path.radiance.h";
    const CpuKernelFunction kernel = find_cpu_kernel(kernel_file, scene.effects.mask());

    const uint32_t pixels = uint32_t(width) * uint32_t(height);
    std::vector<kernel::FilmPixel> film(pixels);
    kernel::FilmWindow window{0, 0, uint32_t(width), uint32_t(height), 0, samples, 0, kernel::SAMPLER_SOBOL};
    uint32_t unfinished = 0;
    void* buffers[] = {&window, &params, film.data()};
    CpuInvocation call;
    call.scene_buffers = cpu.buffers();
    call.kernel_buffers = buffers;
    call.tracer = &cpu.tracer();
    call.unfinished = &unfinished;
    call.begin = 0, call.end = pixels;
    _mm_setcsr(_mm_getcsr() | 0x8040u);
    lampyris_measured_kernel(kernel, call);

    uint64_t hash = 0xcbf29ce484222325u, rays = 0;  // FNV-1a: equal images show that both builds did the same work
    for (const kernel::FilmPixel& pixel : film) {
        rays += pixel.rays;
        unsigned char bytes[sizeof pixel];
        std::memcpy(bytes, &pixel, sizeof pixel);
        for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
    }
    const nlohmann::ordered_json json = {
        {"scene", file}, {"effects", scene.effects.mask()}, {"rays", rays}, {"film_hash", hash}};
    std::printf("%s\n", json.dump().c_str());
    return unfinished ? 1 : 0;
}

}  // namespace
}  // namespace lampyris

int main(int argc, char** argv) {
    int width = 0, height = 0;
    const std::string which = argc == 5 ? argv[4] : "";
    if ((which != "registered" && which != "exact") || std::sscanf(argv[2], "%dx%d", &width, &height) != 2) {
        std::fprintf(stderr, "usage: effects_bench SCENE WIDTHxHEIGHT SAMPLES registered|exact\n");
        return 1;
    }
    try {
        return lampyris::run(argv[1], width, height, uint32_t(std::atoi(argv[3])), which == "exact");
    } catch (const lampyris::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return int(error.code());
    }
}

// Measures how much of the time of path tracing is ray tracing: `path` on the CPU backend, by its scalar build and in vectors, against
// bare Embree on exactly the same rays, in the same process, with the same threads and blocks of work, in alternation. Bare Embree traces
// rays one by one, and in packets of eight; the faster way counts.
//
//     rays_bench SCENE WIDTHxHEIGHT SAMPLES THREADS REPEATS      prints JSON
#include "accel/rays/embree_scene.h"
#include "backends/cpu/cpu_scene.h"
#include "backends/cpu/vectors.h"
#include "core/render/film.h"
#include "core/render/integrator.h"
#include "core/scene/load.h"
#include "integrators/path/path_params.h"

#include <nlohmann/json.hpp>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <xmmintrin.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

namespace lampyris {
namespace {

using Clock = std::chrono::steady_clock;

struct RecordedRay {
    float origin[3], direction[3], t_max;
    bool closest;
};

// Passes rays on to Embree and records them; one thread only.
struct Recorder {
    CpuTracer next;
    std::vector<RecordedRay> rays;
    void add(const float o[3], const float d[3], float t_max, bool closest) {
        rays.push_back({{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, t_max, closest});
    }
    static bool closest(void* self, const float o[3], const float d[3], float t_max, TraceHit& hit) {
        Recorder& recorder = *static_cast<Recorder*>(self);
        recorder.add(o, d, t_max, true);
        return recorder.next.closest(recorder.next.scene, o, d, t_max, hit);
    }
    static bool occluded(void* self, const float o[3], const float d[3], float t_max) {
        Recorder& recorder = *static_cast<Recorder*>(self);
        recorder.add(o, d, t_max, false);
        return recorder.next.occluded(recorder.next.scene, o, d, t_max);
    }
};

template <typename Work>
double timed(tbb::task_arena& arena, size_t count, size_t block, const Work& work) {
    const auto start = Clock::now();
    arena.execute([&] {
        tbb::parallel_for(
            tbb::blocked_range<size_t>(0, count, block),
            [&](const tbb::blocked_range<size_t>& range) { work(range.begin(), range.end()); },
            tbb::simple_partitioner{});
    });
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// The cost of Embree alone: setting up the ray, and the call.
uint64_t trace_bare(RTCScene scene, const RecordedRay* rays, size_t begin, size_t end) {
    uint64_t hits = 0;
    for (size_t i = begin; i < end; ++i) {
        const RecordedRay& r = rays[i];
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit ray;
        ray.ray.org_x = r.origin[0], ray.ray.org_y = r.origin[1], ray.ray.org_z = r.origin[2];
        ray.ray.dir_x = r.direction[0], ray.ray.dir_y = r.direction[1], ray.ray.dir_z = r.direction[2];
        ray.ray.tnear = 0.0f, ray.ray.tfar = r.t_max, ray.ray.time = 0.0f;
        ray.ray.mask = ~0u, ray.ray.id = 0, ray.ray.flags = 0;
        ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        if (r.closest) {
            rtcIntersect1(scene, &context, &ray);
            hits += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        } else {
            rtcOccluded1(scene, &context, &ray.ray);
            hits += ray.ray.tfar < 0.0f;
        }
    }
    return hits;
}

// The same in packets of eight. The rays are those of one kind.
uint64_t trace_packets(RTCScene scene, const RecordedRay* rays, size_t begin, size_t end) {
    uint64_t hits = 0;
    for (size_t first = begin; first < end; first += 8) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit8 packet;
        alignas(32) int32_t valid[8];
        for (size_t l = 0; l < 8; ++l) {
            const RecordedRay& r = rays[std::min(first + l, end - 1)];
            valid[l] = first + l < end ? -1 : 0;
            packet.ray.org_x[l] = r.origin[0], packet.ray.org_y[l] = r.origin[1], packet.ray.org_z[l] = r.origin[2];
            packet.ray.dir_x[l] = r.direction[0], packet.ray.dir_y[l] = r.direction[1];
            packet.ray.dir_z[l] = r.direction[2];
            packet.ray.tnear[l] = 0.0f, packet.ray.tfar[l] = r.t_max, packet.ray.time[l] = 0.0f;
            packet.ray.mask[l] = ~0u, packet.ray.flags[l] = 0;
            packet.hit.geomID[l] = packet.hit.instID[0][l] = RTC_INVALID_GEOMETRY_ID;
        }
        if (rays[first].closest)
            rtcIntersect8(valid, scene, &context, &packet);
        else
            rtcOccluded8(valid, scene, &context, &packet.ray);
        for (size_t l = 0; l < 8 && valid[l]; ++l)
            hits += rays[first].closest ? packet.hit.geomID[l] != RTC_INVALID_GEOMETRY_ID : packet.ray.tfar[l] < 0.0f;
    }
    return hits;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

int run(const std::string& file, int width, int height, uint32_t samples, int threads, int repeats) {
    BuildOptions options;
    options.resolution = {width, height};
    const LoadedScene loaded = load_scene(SceneSource::of_file(file), options, false);
    const Scene& scene = loaded.scene;
    const CpuScene cpu(scene, CpuTracerKind::embree, true);
    PathParams params;
    const IntegratorFactory& factory = integrators().require("path");
    set_defaults(&params, factory.fields);
    Diagnostics diagnostics(*loaded.sources);  // ignored: the scene may name another integrator
    read_parameters(&params, factory.fields, loaded.settings.integrator.parameters, diagnostics);
    const char* file_of_kernel = "integrators/path/path.radiance.h";
    const CpuKernelFunction scalar = find_cpu_kernel(file_of_kernel, scene.effects.mask());
    const auto vectors = compile_in_vectors({file_of_kernel, scene.effects.mask(), read_cache_folder({})}).kernel;

    const uint32_t pixels = uint32_t(width) * uint32_t(height);
    std::vector<kernel::FilmPixel> film(pixels);
    kernel::FilmWindow window{0, 0, uint32_t(width), uint32_t(height), 0, samples, 0, kernel::SAMPLER_SOBOL};
    uint32_t unfinished = 0;
    void* buffers[] = {&window, &params, film.data()};
    const auto path = [&](const CpuTracer& tracer, bool in_vectors, size_t begin, size_t end) {
        CpuInvocation call;
        call.scene_buffers = cpu.buffers();
        call.kernel_buffers = buffers;
        call.tracer = &tracer;
        call.unfinished = &unfinished;
        call.begin = uint32_t(begin), call.end = uint32_t(end);
        in_vectors ? vectors->run(call) : scalar(call);
    };
    Recorder recorder{cpu.tracer(), {}};
    path({&recorder, &Recorder::closest, &Recorder::occluded}, false, 0, pixels);
    const auto first_occluded = std::stable_partition(recorder.rays.begin(), recorder.rays.end(),
                                                      [](const RecordedRay& r) { return r.closest; });
    const size_t closest = size_t(first_occluded - recorder.rays.begin());

    tbb::task_arena arena(threads);
    constexpr size_t kPixelBlock = 64;
    const size_t ray_block = std::max<size_t>(1, recorder.rays.size() * kPixelBlock / pixels);
    std::atomic<uint64_t> hits{0};
    std::vector<double> scalar_s, path_s, singles_s, packets_s, shares;
    const auto timed_path = [&](bool in_vectors) {
        std::fill(film.begin(), film.end(), kernel::FilmPixel{});
        return timed(arena, pixels, kPixelBlock, [&](size_t begin, size_t end) {
            _mm_setcsr(_mm_getcsr() | 0x8040u);
            path(cpu.tracer(), in_vectors, begin, end);
        });
    };
    const auto timed_bare = [&](auto trace) {
        double seconds = 0.0;
        for (const auto& [first, count] :
             {std::pair<size_t, size_t>(0, closest), {closest, recorder.rays.size() - closest}})
            seconds += timed(arena, count, ray_block, [&, first = first](size_t begin, size_t end) {
                hits += trace(cpu.embree()->top_scene(), recorder.rays.data() + first, begin, end);
            });
        return seconds;
    };
    for (int i = 0; i <= repeats; ++i) {
        const double s = timed_path(false), p = timed_path(true);
        const double single = timed_bare(trace_bare), packet = timed_bare(trace_packets);
        if (i == 0) continue;  // the first round warms up
        scalar_s.push_back(s);
        path_s.push_back(p);
        singles_s.push_back(single);
        packets_s.push_back(packet);
        shares.push_back(std::min(single, packet) / p);
    }
    const double rays = double(recorder.rays.size());
    size_t triangles = 0;
    for (const kernel::GeometryRecord& geometry : scene.geometries) triangles += geometry.primitive_count;
    const nlohmann::ordered_json json = {
        {"scene", file},
        {"primitives", triangles},
        {"threads", threads},
        {"rays", recorder.rays.size()},
        {"closest_hit_rays", closest},
        {"path_mrays_per_s", rays / median(path_s) * 1e-6},
        {"scalar_mrays_per_s", rays / median(scalar_s) * 1e-6},
        {"embree_mrays_per_s", rays / std::min(median(singles_s), median(packets_s)) * 1e-6},
        {"singles_mrays_per_s", rays / median(singles_s) * 1e-6},
        {"packets_mrays_per_s", rays / median(packets_s) * 1e-6},
        {"share", median(shares)},
        {"share_min", *std::min_element(shares.begin(), shares.end())},
        {"share_max", *std::max_element(shares.begin(), shares.end())},
        {"samples_per_s", double(pixels) * samples / median(path_s)}};
    std::printf("%s\n", json.dump().c_str());
    return unfinished ? 1 : 0;
}

}  // namespace
}  // namespace lampyris

int main(int argc, char** argv) {
    int width = 0, height = 0;
    if (argc != 6 || std::sscanf(argv[2], "%dx%d", &width, &height) != 2) {
        std::fprintf(stderr, "usage: rays_bench SCENE WIDTHxHEIGHT SAMPLES THREADS REPEATS\n");
        return 1;
    }
    try {
        return lampyris::run(argv[1], width, height, uint32_t(std::atoi(argv[3])), std::atoi(argv[4]),
                             std::atoi(argv[5]));
    } catch (const lampyris::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return int(error.code());
    }
}

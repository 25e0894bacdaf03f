#include "integrators/bidirectional/bidirectional.h"

#include "core/base/error.h"
#include "core/base/registry.h"
#include "core/photons/photon_map.h"
#include "integrators/photon_paths/progressive.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

namespace lampyris {
namespace {

constexpr const char* kLightPaths = "integrators/bidirectional/light_subpaths.kernel.h";
constexpr const char* kCameraPaths = "integrators/bidirectional/camera_subpaths.kernel.h";
constexpr const char* kPixels = "integrators/bidirectional/bidirectional_pixels.kernel.h";
constexpr const char* kMerge = "integrators/bidirectional/merge.consumer.h";

constexpr uint32_t kPart = 1u << 18;          // light paths whose vertices are stored at once
constexpr uint32_t kVerticesPerPath = 4;      // room for them at first
constexpr uint32_t kMostVertices = 1u << 21;  // 128 MiB: lavapipe binds no larger buffers
// Photons found by chance, each counted as several, have more noise than the heuristics assume. Counting this part of them in the
// weights alone keeps the sum of weights at 1, and lowers the variance.
constexpr float kStochasticShare = 0.25f;

constexpr double kLeastRadius = 1e-6;  // of merging, as a share of the scene's: as sppm's minradius

using Counters = std::array<uint32_t, kernel::BIDIRECTIONAL_COUNTERS>;

class BidirectionalRender {
 public:
    BidirectionalRender(RenderSession& session, const BidirectionalOptions& options)
        : session_(session),
          device_(session.device),
          options_(options),
          merges_(options.radius >= 0.0),
          pixels_(session.film.pixel_count()),
          light_paths_(device_.compile(kLightPaths, session.scene.effects.mask())),
          camera_paths_(device_.compile(kCameraPaths, session.scene.effects.mask())),
          finish_(device_.compile(kPixels, session.scene.effects.mask())) {
        describe_pass();
        part_ = std::min(pass_.paths, kPart);
        splats_ = device_.create_buffer(splat_bytes(pixels_, options.name), "splats");
        seen_ = device_.create_buffer(size_t(pixels_) * sizeof(glm::vec4), "radiance of camera paths");
        connected_ = device_.create_buffer(options.shares ? size_t(pixels_) * 4 : 4, "radiance by connections");
        shares_ = device_.create_buffer((options.shares ? pixels_ : 1) * sizeof(glm::vec4), "radiance by strategies");
        shares_->fill_zero();
        last_ = device_.create_buffer(size_t(part_) * 4, "last vertices of light paths");
        last_merged_ = device_.create_buffer(merges_ ? size_t(pixels_) * 4 : 4, "last merged vertices of pixels");
        make_vertices(
            options.strategies == kernel::STRATEGIES_ALL && options.connections != 0 ? part_ * kVerticesPerPath : 1);
        make_photons(merges_ ? part_ * kVerticesPerPath : 1);
        make_sums(merges_ ? part_ * uint32_t(std::clamp(options.maxdepth, 1, 8)) : 1);
        make_queries(merges_ ? pixels_ * kVerticesPerPath : 1);
        if (merges_) open_map();
        run_light_paths(0, 0);  // compiles, if need be, before the clock starts
        run_camera_paths(0);
        run_finish(0);
    }

    void render() {
        keep_state();
        while (const uint32_t count = session_.next_passes()) {
            for (uint32_t i = 0; i < count; ++i) render_pass(session_.next_pass() + i);
            session_.passes_finished(count);
        }
        if (merges_) finish_statistics();
        if (!options_.shares) return;
        options_.shares->resize(pixels_);
        shares_->download(options_.shares->data(), pixels_ * sizeof(glm::vec4));
    }

 private:
    // How a pass is divided: with a cache, or a map that chooses by chance, the image depends on it.
    void keep_state() {
        const uint32_t most = part_, capacity = pass_.sums_capacity;
        session_.keep_value("paths of a part", part_);
        session_.keep_value("weights of photons", pass_.sums_capacity);
        if (part_ < 1 || part_ > most || pass_.sums_capacity < 1 || pass_.sums_capacity > kMostVertices * 2)
            throw InputError("error: the checkpoint cannot be resumed: how it divides passes is out of range");
        if (pass_.sums_capacity != capacity) make_sums(pass_.sums_capacity);
    }

    void describe_pass() {
        const Scene& scene = session_.scene;
        const uint32_t full = scene.width() * scene.height();
        pass_.seed = session_.seed;
        pass_.sampler_kind = session_.sampler;
        pass_.paths = light_path_count(options_, scene);
        pass_.maxdepth = options_.maxdepth;
        pass_.rrdepth = options_.rrdepth;
        pass_.connections = options_.connections;
        pass_.cache = uint32_t(options_.cache);
        pass_.samples = float(std::max(options_.cache, 1));
        pass_.weights = options_.weights;
        pass_.only_light = options_.only_light;
        pass_.only_camera = options_.only_camera;
        pass_.strategies = options_.strategies;
        pass_.quantum = splat_quantum(scene);
        pass_.brightness = float(double(pass_.paths) / double(full));
        pass_.film_density = film_density(scene);
        pass_.shares = options_.shares ? 1 : 0;
    }

    void open_map() {
        map_ = create_photon_map(session_.photon_map);
        const PhotonMapCapabilities can = map_->capabilities();
        if (can.lossy)
            throw InputError(
                fmt::format("error: photon map \"{}\" may drop photons, and \"{}\" weighs them by how many there are: "
                            "use another map",
                            session_.photon_map, options_.name));
        share_ = can.stochastic ? kStochasticShare : 1.0f;
        map_->open(device_);
        map_->prepare(consumer());
    }

    PhotonConsumer consumer() const {
        return {kMerge,
                session_.scene.effects.mask(),
                session_.device_scene.get(),
                {{"passes", passes_}, {"merged", merged_}, {"photon_sums", sums_}, {"gathered", gathered_}}};
    }

    // ---- Buffers that grow -------------------------------------------------------------------------------------------

    void make_vertices(uint32_t count) {
        pass_.capacity = count;
        vertices_.reset();
        vertices_ = device_.create_buffer(size_t(count) * sizeof(kernel::PathVertexRecord), "light vertices");
    }
    void make_photons(uint32_t count) {
        pass_.photon_capacity = count;
        photons_.reset();
        photons_ = device_.create_buffer(size_t(count) * sizeof(kernel::PhotonRecord), "photons");
    }
    void make_sums(uint32_t count) {
        pass_.sums_capacity = count;
        sums_.reset();
        sums_ = device_.create_buffer(size_t(count) * sizeof(glm::vec4), "weights of photons");
    }
    void make_queries(uint32_t count) {
        pass_.query_capacity = count;
        merged_.reset(), queries_.reset(), gathered_.reset();
        merged_ = device_.create_buffer(size_t(count) * sizeof(kernel::PathVertexRecord), "camera vertices");
        queries_ = device_.create_buffer(size_t(count) * sizeof(glm::vec4), "places of camera vertices");
        gathered_ = device_.create_buffer(size_t(count) * sizeof(glm::vec4), "radiance by merging");
    }

    // ---- Kernels -----------------------------------------------------------------------------------------------------

    void run_light_paths(uint32_t first, uint32_t count) {
        const std::array<NamedBuffer, 8> buffers{{{"window", window_},
                                                  {"passes", passes_},
                                                  {"splats", splats_},
                                                  {"counters", counters_},
                                                  {"vertices", vertices_},
                                                  {"last_vertices", last_},
                                                  {"photons", photons_},
                                                  {"photon_sums", sums_}}};
        device_.run(*light_paths_, session_.device_scene.get(), buffers, first, count);
    }
    void run_camera_paths(uint32_t count) {
        const std::array<NamedBuffer, 11> buffers{{{"window", window_},
                                                   {"passes", passes_},
                                                   {"film", session_.film.buffer()},
                                                   {"counters", counters_},
                                                   {"vertices", vertices_},
                                                   {"last_vertices", last_},
                                                   {"seen", seen_},
                                                   {"merged", merged_},
                                                   {"queries", queries_},
                                                   {"last_merged", last_merged_},
                                                   {"connected", connected_}}};
        device_.run(*camera_paths_, session_.device_scene.get(), buffers, 0, count);
    }
    void run_finish(uint32_t count) {
        const std::array<NamedBuffer, 10> buffers{{{"window", window_},
                                                   {"passes", passes_},
                                                   {"film", session_.film.buffer()},
                                                   {"splats", splats_},
                                                   {"seen", seen_},
                                                   {"merged", merged_},
                                                   {"last_merged", last_merged_},
                                                   {"gathered", gathered_},
                                                   {"connected", connected_},
                                                   {"shares", shares_}}};
        device_.run(*finish_, session_.device_scene.get(), buffers, 0, count);
    }
    void upload_pass() { passes_->upload(&pass_, sizeof pass_); }
    Counters counters() const {
        Counters values{};
        counters_->download(&values, sizeof values);
        return values;
    }

    // ---- A pass ------------------------------------------------------------------------------------------------------

    void render_pass(uint64_t number) {
        pass_.number = uint32_t(number);
        set_radius(number);
        const kernel::FilmWindow window = session_.window(pass_.number, 1);
        window_->upload(&window, sizeof window);
        splats_->fill_zero();
        splatted_ = 0;
        query_count_ = 0;
        kept_ = {};
        for (uint32_t first = 0; first < pass_.paths;) {
            pass_.splats = first >= splatted_ ? 1 : 0;
            const uint32_t end = pass_.splats != 0 ? pass_.paths : splatted_;
            const uint32_t count = std::min(part_, end - first);
            if (!trace_light_paths(first, count)) continue;
            session_.add_count("light_paths", count);
            session_.add_count("light_vertices", kept_[kernel::LIGHT_VERTICES]);
            trace_camera_paths();
            first += count;
        }
        if (merges_) merge();
        run_finish(pixels_);
        if (session_.path_log) session_.path_log->follow_light_paths([&](uint32_t path) { trace_again(path); });
    }

    // One path, with its splats, for the path log: the pass is finished.
    void trace_again(uint32_t path) {
        pass_.first_path = path;
        pass_.part_paths = 1;
        pass_.splats = 1;
        upload_pass();
        run_light_paths(path, 1);
    }

    double first_radius() const {
        return options_.radius > 0.0 ? options_.radius : options_.radius_share * double(session_.scene.record.bounds.w);
    }

    void set_radius(uint64_t number) {
        if (!merges_) return;
        const double scene_radius = double(session_.scene.record.bounds.w);
        // For smaller disks, rounding errors of positions would matter.
        const double radius =
            std::max(first_radius() * std::sqrt(memoryless_scale(number, options_.alpha)), kLeastRadius * scene_radius);
        pass_.radius = float(radius);
        const double area = std::numbers::pi * (radius / scene_radius) * (radius / scene_radius);
        pass_.eta = float(std::max(area * double(pass_.paths) * double(share_), 1e-30));
    }

    // False if the vertices or photons did not fit: then there is more room, or a smaller part, and the paths have to be traced
    // again. Their splats are complete nevertheless.
    bool trace_light_paths(uint32_t first, uint32_t count) {
        pass_.first_path = first;
        pass_.part_paths = count;
        upload_pass();
        counters_->fill_zero();
        if (session_.scene.record.light_count == 0) return true;
        run_light_paths(first, count);
        splatted_ = std::max(splatted_, first + count);
        kept_ = counters();
        pass_.deepest = int(kept_[kernel::DEEPEST_VERTEX]);
        session_.photons.rays += kept_[kernel::LIGHT_RAYS];
        const uint32_t vertices = kept_[kernel::LIGHT_VERTICES], photons = kept_[kernel::PHOTONS_KEPT];
        bool fits = true;
        // Whatever room there is from earlier passes, so that they do not decide.
        if (std::max(vertices, photons) > kMostVertices && count > 1) {
            part_ = std::max(1u, std::min(part_, count / 2));
            fits = false;
        } else {
            if (vertices > pass_.capacity) make_vertices(vertices + vertices / 8), fits = false;
            if (photons > pass_.photon_capacity) make_photons(photons + photons / 8), fits = false;
        }
        // A photon's place among the sums is its number times the paths, plus the path's.
        if (merges_ && kept_[kernel::MOST_PHOTONS] > pass_.sums_capacity / count) {
            const uint32_t numbers = kept_[kernel::MOST_PHOTONS] + 1;  // of photons of a path
            make_sums(std::min(part_, kMostVertices / numbers) * numbers);
            part_ = std::max(1u, std::min(part_, kMostVertices / numbers));
            fits = false;
        }
        if (pass_.splats != 0) session_.add_count("splats", kept_[kernel::LIGHT_SPLATS]);
        return fits;
    }

    void trace_camera_paths() {
        pass_.features = 1;
        while (true) {
            upload_pass();
            Counters now = kept_;
            now[kernel::MERGE_QUERIES] = query_count_;
            counters_->upload(&now, sizeof now);
            run_camera_paths(pixels_);
            now = counters();
            if (now[kernel::MERGE_QUERIES] <= pass_.query_capacity) {
                session_.add_count("connections_tried", now[kernel::CONNECTIONS_TRIED]);
                session_.add_count("connections_visible", now[kernel::CONNECTIONS_VISIBLE]);
                session_.add_count("camera_vertices_merged", now[kernel::MERGE_QUERIES] - query_count_);
                query_count_ = now[kernel::MERGE_QUERIES];
                return;
            }
            grow_queries(now[kernel::MERGE_QUERIES]);
            pass_.features = 0;  // the film has them already
        }
    }

    // More room for camera vertices; those of earlier parts stay.
    void grow_queries(uint32_t needed) {
        std::vector<kernel::PathVertexRecord> vertices(query_count_);
        std::vector<glm::vec4> places(query_count_);
        merged_->download(vertices.data(), vertices.size() * sizeof(vertices[0]));
        queries_->download(places.data(), places.size() * sizeof(places[0]));
        make_queries(needed + needed / 8);
        merged_->upload(vertices.data(), vertices.size() * sizeof(vertices[0]));
        queries_->upload(places.data(), places.size() * sizeof(places[0]));
    }

    void merge() {
        gathered_->fill_zero();
        if (query_count_ == 0) return;
        // The photons of the last part are still there.
        gather(kept_[kernel::PHOTONS_KEPT]);
        const uint32_t last = pass_.first_path;
        pass_.splats = 0;
        for (uint32_t first = 0; first < last;) {
            const uint32_t count = std::min(part_, last - first);
            if (!trace_light_paths(first, count)) continue;
            gather(kept_[kernel::PHOTONS_KEPT]);
            first += count;
        }
    }

    void gather(uint32_t count) {
        session_.photons.emitted += pass_.part_paths;
        session_.photons.stored += count;
        if (count == 0) return;
        const glm::vec3 centre(session_.scene.record.bounds);
        const float radius = session_.scene.record.bounds.w;
        PhotonSet set;
        set.photons = photons_;
        set.count = count;
        set.queries = queries_;
        set.query_count = query_count_;
        set.radius = pass_.radius;
        set.low = centre - radius;
        set.high = centre + radius;
        set.seed = session_.seed;
        set.pass = pass_.number * 0x9e3779b9u + pass_.first_path;  // each part has its own grid
        set.mean_power = session_.scene.record.light_power / float(pass_.paths);
        if (session_.path_log) session_.path_log->photons_are_of(pass_.first_path, pass_.part_paths);
        map_->build(set);
        map_->gather(consumer(), queries_, 0, query_count_);
    }

    void finish_statistics() {
        PhotonStatistics& photons = session_.photons;
        const PhotonMapStatistics statistics = map_->statistics();
        session_.add_phase("construction", statistics.construction_kernel_s);
        session_.add_phase("gathering", statistics.gathering_kernel_s);
        photons.map_bytes += map_->memory_bytes();
        photons.map_parameters = show_photon_map(parse_plugin_choice(session_.photon_map).name, *map_);
        if (const auto load = map_->bucket_load())
            photons.bucket_load_mean = load->mean, photons.bucket_load_max = load->max;
        photons.radius_initial = first_radius();
        photons.radius_min = photons.radius_mean = photons.radius_max = pass_.radius;
    }

    RenderSession& session_;
    Device& device_;
    const BidirectionalOptions options_;
    const bool merges_;
    const uint32_t pixels_;
    kernel::BidirectionalPass pass_{};
    uint32_t part_ = 0;
    uint32_t splatted_ = 0;     // light paths of this pass whose splats are complete
    uint32_t query_count_ = 0;  // camera vertices of this pass that are merged
    float share_ = 1.0f;        // of photons, in weights
    Counters kept_{};           // after the last part of light paths
    KernelHandle light_paths_, camera_paths_, finish_;
    BufferHandle window_ = device_.create_buffer(sizeof(kernel::FilmWindow), "film window");
    BufferHandle passes_ = device_.create_buffer(sizeof(kernel::BidirectionalPass), "pass");
    BufferHandle counters_ = device_.create_buffer(sizeof(Counters), "counters");
    BufferHandle splats_, seen_, connected_, shares_, last_, last_merged_, vertices_, photons_, sums_, merged_,
        queries_, gathered_;
    std::unique_ptr<PhotonMap> map_;
};

}  // namespace

void render_bidirectional(RenderSession& session, const BidirectionalOptions& options) {
    if (options.light_paths)
        BidirectionalRender(session, options).render();
    else
        render_camera_paths(session, options);
}

}  // namespace lampyris

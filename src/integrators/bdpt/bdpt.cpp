#include "core/render/integrator.h"
#include "integrators/bdpt/bdpt_params.h"
#include "integrators/bidirectional/bidirectional_host.h"

#include <algorithm>
#include <array>

namespace lampyris {
namespace {

constexpr const char* kLightPaths = "integrators/bdpt/bdpt_light_paths.kernel.h";
constexpr const char* kCameraPaths = "integrators/bdpt/bdpt_camera_paths.kernel.h";
constexpr const char* kPixels = "integrators/bdpt/bdpt_pixels.kernel.h";

constexpr uint32_t kPart = 1u << 18;          // light paths whose vertices are stored at once
constexpr uint32_t kVerticesPerPath = 4;      // room for them at first
constexpr uint32_t kMostVertices = 1u << 21;  // 128 MiB: lavapipe binds no larger buffers

using Counters = std::array<uint32_t, kernel::BIDIRECTIONAL_COUNTERS>;

class BdptRender {
 public:
    BdptRender(RenderSession& session, const BdptParams& params)
        : session_(session),
          device_(session.device),
          pixels_(session.film.pixel_count()),
          light_paths_(device_.compile(kLightPaths, session.scene.effects.mask())),
          camera_paths_(device_.compile(kCameraPaths, session.scene.effects.mask())),
          finish_(device_.compile(kPixels, session.scene.effects.mask())) {
        const uint32_t full = session.scene.width() * session.scene.height();
        pass_.seed = session.seed;
        pass_.sampler_kind = session.sampler;
        pass_.paths = params.lightpaths > 0 ? uint32_t(params.lightpaths) : full;
        pass_.maxdepth = params.maxdepth;
        pass_.rrdepth = params.rrdepth;
        pass_.connections = params.connections;
        pass_.weights = params.weights;
        pass_.only_light = params.s;
        pass_.only_camera = params.t;
        pass_.quantum = splat_quantum(session.scene);
        pass_.brightness = float(double(pass_.paths) / double(full));
        const kernel::CameraRecord& camera = session.scene.record.camera;
        const float filter_area = 4.0f * camera.filter_radius_x * camera.filter_radius_y;  // in pixels
        pass_.film_density = 1.0f / std::clamp(filter_area, 1e-12f, 1.0f);
        part_ = std::min(pass_.paths, kPart);
        splats_ = device_.create_buffer(splat_bytes(pixels_, "bdpt"), "splats");
        seen_ = device_.create_buffer(size_t(pixels_) * sizeof(glm::vec4), "radiance of camera paths");
        last_ = device_.create_buffer(size_t(part_) * 4, "last vertices of light paths");
        make_store(part_ * kVerticesPerPath);
        prepare();
    }

    void render() {
        while (const uint32_t count = session_.next_passes()) {
            for (uint32_t i = 0; i < count; ++i) render_pass(uint32_t(session_.next_pass() + i));
            session_.passes_finished(count);
        }
    }

 private:
    void make_store(uint32_t vertices) {
        pass_.capacity = vertices;
        store_.reset();
        store_ = device_.create_buffer(size_t(vertices) * sizeof(kernel::LightVertexRecord), "light vertices");
    }

    // Compiles the kernels for these buffers, if need be, before the clock starts.
    void prepare() {
        run_light_paths(0, 0);
        run_camera_paths(0);
        run_finish(0);
    }

    void run_light_paths(uint32_t first, uint32_t count) {
        const std::array<NamedBuffer, 6> buffers{{{"window", window_},
                                                  {"passes", passes_},
                                                  {"splats", splats_},
                                                  {"counters", counters_},
                                                  {"vertices", store_},
                                                  {"last_vertices", last_}}};
        device_.run(*light_paths_, session_.device_scene.get(), buffers, first, count);
    }

    void run_camera_paths(uint32_t count) {
        const std::array<NamedBuffer, 7> buffers{{{"window", window_},
                                                  {"passes", passes_},
                                                  {"film", session_.film.buffer()},
                                                  {"counters", counters_},
                                                  {"vertices", store_},
                                                  {"last_vertices", last_},
                                                  {"seen", seen_}}};
        device_.run(*camera_paths_, session_.device_scene.get(), buffers, 0, count);
    }

    void run_finish(uint32_t count) {
        const std::array<NamedBuffer, 5> buffers{{{"window", window_},
                                                  {"passes", passes_},
                                                  {"film", session_.film.buffer()},
                                                  {"splats", splats_},
                                                  {"seen", seen_}}};
        device_.run(*finish_, session_.device_scene.get(), buffers, 0, count);
    }

    void render_pass(uint32_t number) {
        pass_.number = number;
        const kernel::FilmWindow window = session_.window(number, 1);
        window_->upload(&window, sizeof window);
        splats_->fill_zero();
        splatted_ = 0;
        for (uint32_t first = 0; first < pass_.paths;) {
            pass_.splats = first >= splatted_ ? 1 : 0;
            const uint32_t end = pass_.splats != 0 ? pass_.paths : splatted_;
            const uint32_t count = std::min(part_, end - first);
            if (!trace_light_paths(first, count)) continue;
            run_camera_paths(pixels_);
            first += count;
        }
        run_finish(pixels_);
    }

    // False if the vertices did not fit: then there is more room, or a smaller part, and the paths have to be traced again. Their
    // splats are complete nevertheless.
    bool trace_light_paths(uint32_t first, uint32_t count) {
        pass_.first_path = first;
        pass_.part_paths = count;
        passes_->upload(&pass_, sizeof pass_);
        counters_->fill_zero();
        if (session_.scene.record.light_count == 0) return true;
        run_light_paths(first, count);
        splatted_ = std::max(splatted_, first + count);
        Counters counters{};
        counters_->download(&counters, sizeof counters);
        session_.photons.rays += counters[kernel::LIGHT_RAYS];
        const uint32_t stored = counters[kernel::LIGHT_VERTICES];
        if (stored <= pass_.capacity) return true;
        if (stored <= kMostVertices || count == 1)
            make_store(stored + stored / 8);
        else
            part_ = count / 2;
        return false;
    }

    RenderSession& session_;
    Device& device_;
    const uint32_t pixels_;
    kernel::BidirectionalPass pass_{};
    uint32_t part_ = 0;
    uint32_t splatted_ = 0;  // light paths of this pass whose splats are complete
    KernelHandle light_paths_, camera_paths_, finish_;
    BufferHandle window_ = device_.create_buffer(sizeof(kernel::FilmWindow), "film window");
    BufferHandle passes_ = device_.create_buffer(sizeof(kernel::BidirectionalPass), "pass");
    BufferHandle counters_ = device_.create_buffer(sizeof(Counters), "counters");
    BufferHandle splats_, seen_, last_, store_;
};

class Bdpt : public Integrator {
 public:
    BdptParams params;

    void render(RenderSession& session) override { BdptRender(session, params).render(); }
};

REGISTER_INTEGRATOR(Bdpt, BDPT_PARAMS, "bdpt",
                    "Bidirectional path tracing: paths from the camera and from lights, connected in all ways.")

}  // namespace
}  // namespace lampyris

#include "core/render/integrator.h"
#include "integrators/bidirectional/bidirectional_host.h"
#include "integrators/light/light_host.h"
#include "integrators/light/light_params.h"

#include <algorithm>
#include <array>

namespace lampyris {
namespace {

constexpr const char* kPaths = "integrators/light/light_paths.kernel.h";
constexpr const char* kPixels = "integrators/light/light_pixels.kernel.h";

// Light paths of one run of the kernel, whose rays a word counts.
constexpr uint32_t kPart = 1u << 22;

class Light : public Integrator {
 public:
    LightParams params;

    void render(RenderSession& session) override {
        Device& device = session.device;
        const uint64_t effects = session.scene.effects.mask();
        const uint32_t pixels = session.film.pixel_count();
        const uint32_t full = session.scene.width() * session.scene.height();
        kernel::LightPass pass{};
        pass.seed = session.seed;
        pass.sampler_kind = session.sampler;
        pass.paths = params.lightpaths > 0 ? uint32_t(params.lightpaths) : full;
        pass.maxdepth = params.maxdepth;
        pass.quantum = splat_quantum(session.scene);
        pass.brightness = float(double(pass.paths) / double(full));
        const KernelHandle paths = device.compile(kPaths, effects), finish = device.compile(kPixels, effects);
        const BufferHandle window = device.create_buffer(sizeof(kernel::FilmWindow), "film window");
        const BufferHandle passes = device.create_buffer(sizeof pass, "pass");
        const BufferHandle splats = device.create_buffer(splat_bytes(pixels, "light"), "splats");
        const BufferHandle rays = device.create_buffer(4, "rays of light paths");
        const std::array<NamedBuffer, 4> of_paths{
            {{"window", window}, {"passes", passes}, {"splats", splats}, {"rays", rays}}};
        const std::array<NamedBuffer, 4> of_pixels{
            {{"window", window}, {"passes", passes}, {"splats", splats}, {"film", session.film.buffer()}}};
        const DeviceScene* scene = session.device_scene.get();
        device.run(*paths, scene, of_paths, 0, 0);  // compiles, if need be, before the clock starts
        device.run(*finish, scene, of_pixels, 0, 0);
        const bool lit = session.scene.record.light_count > 0;
        while (const uint32_t count = session.next_passes()) {
            for (uint32_t i = 0; i < count; ++i) {
                pass.number = uint32_t(session.next_pass() + i);
                passes->upload(&pass, sizeof pass);
                const kernel::FilmWindow one = session.window(pass.number, 1);
                window->upload(&one, sizeof one);
                splats->fill_zero();
                for (uint32_t done = 0; lit && done < pass.paths;) {
                    const uint32_t part = std::min(pass.paths - done, kPart);
                    rays->fill_zero();
                    device.run(*paths, scene, of_paths, done, part);
                    uint32_t traced = 0;
                    rays->download(&traced, 4);
                    session.photons.rays += traced;
                    done += part;
                }
                device.run(*finish, scene, of_pixels, 0, pixels);
                if (session.path_log)
                    session.path_log->follow_light_paths(
                        [&](uint32_t path) { device.run(*paths, scene, of_paths, path, 1); });
            }
            session.passes_finished(count);
        }
    }
};

REGISTER_INTEGRATOR(Light, LIGHT_PARAMS, "light",
                    "Light tracing: paths from lights, whose vertices are connected to the camera.")

}  // namespace
}  // namespace lampyris

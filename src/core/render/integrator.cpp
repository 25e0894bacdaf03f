#include "core/render/integrator.h"

#include "core/render/sample_slices.h"

#include <vector>

namespace lampyris {

Registry<IntegratorFactory>& integrators() {
    static Registry<IntegratorFactory> registry("integrator",
                                                "How light is transported: the algorithm that makes the image.");
    return registry;
}

IntegratorRegistration::IntegratorRegistration(const char* name, const char* summary, IntegratorFactory factory) {
    ParameterSpecs specs = specs_of(factory.fields);
    integrators().add({name, summary, std::move(specs)}, std::move(factory));
}

void render_samples(RenderSession& session, const char* kernel_file, const void* parameters, size_t parameter_bytes) {
    Device& device = session.device;
    const KernelHandle kernel = device.compile(kernel_file, session.scene.effects.mask());
    const BufferHandle window = device.create_buffer(sizeof(kernel::FilmWindow), "film window");
    const BufferHandle params = device.create_buffer(std::max<size_t>(parameter_bytes, 4), "parameters");
    if (parameter_bytes) params->upload(parameters, parameter_bytes);
    std::vector<NamedBuffer> buffers{{"window", window}, {"film", session.film.buffer()}};
    if (kernel->declares("params")) buffers.push_back({"params", params});  // a kernel need not declare any
    device.run(*kernel, session.device_scene.get(), buffers, 0, 0);  // compiles, if need be, before the clock starts
    SampleSlices slices(device, session.film);
    while (const uint32_t count = session.next_passes()) {
        slices.run(uint32_t(session.next_pass()), count, [&](uint32_t first, uint32_t samples) {
            const kernel::FilmWindow slice = session.window(first, samples);
            window->upload(&slice, sizeof(slice));
            device.run(*kernel, session.device_scene.get(), buffers, 0, session.film.pixel_count());
        });
        session.passes_finished(count);
    }
}

}  // namespace lampyris

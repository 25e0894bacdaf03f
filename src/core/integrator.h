// An integrator is a schedule: a list of device.run(kernel, ...) that knows no backend. It registers itself by name:
//     class Ao final : public Integrator { public: AoParams params; void render(RenderSession& session) override; };
//     REGISTER_INTEGRATOR(Ao, AO_PARAMS, "ao", "Ambient occlusion: the share of the sky that each point sees.")
#pragma once

#include "core/parameters.h"
#include "core/registry.h"
#include "core/render_session.h"

#include <memory>
#include <string>

namespace lampyris {

class Integrator {
 public:
    virtual ~Integrator() = default;
    // Runs passes until the session's budget is spent.
    virtual void render(RenderSession& session) = 0;
    // The struct that `fields` of its registration describe.
    virtual void* parameters() = 0;
    // Whether it looks photons up: with the structure of session.photon_map.
    virtual bool uses_photon_map() const { return false; }
    // Whether passes share one set of eye samples (--spp), and --passes alone counts passes.
    virtual bool fixes_eye_samples() const { return false; }
    // How fast theory lets the error fall, with the parameters as they are. Photons in radii that stay as they are leave a bias that
    // no pass takes away.
    virtual ErrorRate error_rate() const {
        return uses_photon_map() ? ErrorRate::of_photons(1.0) : ErrorRate::of_samples();
    }
    // Error that the variance between passes cannot reveal, in a few words: what all passes share. Empty where there is none.
    virtual std::string unseen_error([[maybe_unused]] uint32_t eye_samples) const { return {}; }
};

struct IntegratorFactory {
    std::unique_ptr<Integrator> (*create)() = nullptr;
    ParameterFields fields;
};

Registry<IntegratorFactory>& integrators();

template <typename Class>
class RegisteredIntegrator final : public Class {
 public:
    void* parameters() override { return &this->params; }
    static std::unique_ptr<Integrator> create() { return std::make_unique<RegisteredIntegrator>(); }
};

struct IntegratorRegistration {
    IntegratorRegistration(const char* name, const char* summary, IntegratorFactory factory);
};

#define REGISTER_INTEGRATOR(Class, LIST, name, summary)                                 \
    static const ::lampyris::IntegratorRegistration registration_of_##Class(            \
        name, summary,                                                                  \
        ::lampyris::IntegratorFactory{&::lampyris::RegisteredIntegrator<Class>::create, \
                                      PARAMETER_FIELDS(decltype(Class::params), LIST)});

// An upload of one struct as a kernel's argument buffer.
template <typename T>
BufferHandle argument_buffer(Device& device, const T& value, const char* name) {
    BufferHandle buffer = device.create_buffer(sizeof(T), name);
    buffer->upload(&value, sizeof(T));
    return buffer;
}

// The schedule of integrators that take samples of pixels one by one: one kernel, run with the buffers
// (0: FilmWindow, 1: parameters, 2: film) for slices of samples.
void render_samples(RenderSession& session, const char* kernel_file, const void* parameters, size_t parameter_bytes);

}  // namespace lampyris

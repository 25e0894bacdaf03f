// An integrator is a schedule: a list of device.run(kernel, ...), independent of the backend. It registers itself by name:
//     class Ao final : public Integrator { public: AoParams params; void render(RenderSession& session) override; };
//     REGISTER_INTEGRATOR(Ao, AO_PARAMS, "ao", "Ambient occlusion: the share of the sky that each point sees.")
#pragma once

#include "core/base/parameters.h"
#include "core/base/registry.h"
#include "core/render/render_session.h"

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
    // Whether it uses a photon map: that of session.photon_map.
    virtual bool uses_photon_map() const { return false; }
    // Whether passes share one set of eye samples, whose number --spp sets; then only --passes limits the passes.
    virtual bool fixes_eye_samples() const { return false; }
    // How fast the error falls in theory, with the current parameters. With fixed radii, the photons leave a bias that no
    // number of passes removes.
    virtual ErrorRate error_rate() const {
        return uses_photon_map() ? ErrorRate::of_photons(1.0) : ErrorRate::of_samples();
    }
    // An error that all passes share, so that the variance between them cannot reveal it, in a few words. Empty if there is
    // none.
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

// For an integrator that is nothing but a radiance function (NAME.radiance.h), which is rendered by render_samples.
#define REGISTER_RADIANCE(Params, LIST, name, file, summary)                    \
    namespace {                                                                 \
    class IntegratorOf##Params : public ::lampyris::Integrator {                \
     public:                                                                    \
        Params params;                                                          \
        void render(::lampyris::RenderSession& session) override {              \
            ::lampyris::render_samples(session, file, &params, sizeof(params)); \
        }                                                                       \
    };                                                                          \
    REGISTER_INTEGRATOR(IntegratorOf##Params, LIST, name, summary)              \
    }

// Uploads one struct as a kernel's argument buffer.
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

// The library's front door: core/render/render.h.
#include "core/render/render.h"

#include "core/device/effects.h"
#include "core/render/integrator.h"
#include "integrators/photon_paths/progressive_params.h"
#include "support/render.h"
#include "support/render_error.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <map>
#include <stdexcept>
#include <thread>

namespace lampyris::test {
namespace {

constexpr const char* kScene =
    "LookAt 0 0 -4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n"
    "Sampler \"independent\" \"integer pixelsamples\" 4\n"
    "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 8\n"
    "WorldBegin\n"
    "AttributeBegin\nTranslate 0 2 -3\nAreaLightSource \"diffuse\" \"rgb L\" [ 5 4 3 ]\n"
    "Shape \"sphere\" \"float radius\" 0.4\nAttributeEnd\n"
    "Material \"diffuse\" \"rgb reflectance\" [ 0.8 0.5 0.2 ]\nShape \"sphere\" \"float radius\" 1\n";

RenderRequest request_of(const std::string& integrator = "path", uint64_t passes = 8) {
    RenderRequest request;
    request.scene = SceneSource::of_text(kScene, "lamp.pbrt");
    request.integrator = integrator;
    request.limits.passes = passes;
    return request;
}

// Calls a function when progress is reported.
class Listener final : public RenderObserver {
 public:
    std::function<void(const RenderProgress&)> on_progress;
    std::vector<std::string> warnings;
    void warning(const std::string& text) override { warnings.push_back(text); }
    void progress(const RenderProgress& progress, const Film&) override {
        if (on_progress) on_progress(progress);
    }
    // Once: the interruption does not apply to the next run.
    void interrupt_at(uint64_t passes) {
        on_progress = [this, passes](const RenderProgress& progress) {
            if (progress.passes < passes) return;
            on_progress = nullptr;
            interrupt();
        };
    }
};

TEST(Render, ASceneFromTextIsAnImage) {
    RenderRequest request = request_of("");
    request.limits.passes.reset();
    const RenderOutcome outcome = render(request);
    EXPECT_EQ(outcome.image.width, 12);
    EXPECT_EQ(outcome.image.height, 8);
    EXPECT_GT(outcome.image.at(6, 2, 0), outcome.image.at(6, 2, 2));  // orange under a warm lamp
    EXPECT_EQ(outcome.image.at(0, 7, 0), 0.0f);                       // and nothing behind
    EXPECT_EQ(outcome.record.ended, RenderEnd::kPasses);
    EXPECT_EQ(outcome.record.progress.passes, 4u) << "the scene's samples, where no limit is given";
    EXPECT_EQ(outcome.record.integrator, "path");
    EXPECT_EQ(outcome.image.metadata.at("lampyris.scene"), "lamp.pbrt");
}

TEST(Render, AllErrorsOfASceneComeWithTheirPlaces) {
    RenderRequest request = request_of();
    request.scene.text->append("Shap \"sphere\"\n  Shape \"sphere\" \"float radios\" 1\n");
    const std::string error = error_of(request);
    EXPECT_NE(error.find("lamp.pbrt:13:1: error: "), std::string::npos) << error;
    EXPECT_NE(error.find("lamp.pbrt:14:18: error: "), std::string::npos) << error;
    EXPECT_NE(error.find("radius"), std::string::npos) << error;
}

TEST(Render, WarningsComeBeforeErrors) {
    RenderRequest request = request_of();
    request.skip_unsupported = true;
    request.scene.text->append("Shape \"curve\"\nShap\n");
    Listener listener;
    EXPECT_THROW(render(request, listener), InputError);
    ASSERT_FALSE(listener.warnings.empty());
    EXPECT_TRUE(listener.warnings[0].starts_with("lamp.pbrt:13:7: warning: ")) << listener.warnings[0];
}

TEST(Render, WhatIsWrongWithARequestIsAnError) {
    const auto with = [](const std::function<void(RenderRequest&)>& change) {
        RenderRequest request = request_of();
        change(request);
        return error_of(request);
    };
    const auto expect = [](const std::string& error, const std::string& words) {
        EXPECT_NE(error.find(words), std::string::npos) << error;
    };
    expect(with([](RenderRequest& r) { r.integrator = "pth"; }), "unknown integrator \"pth\"");
    expect(with([](RenderRequest& r) { r.integrator = "path:maxdepht=2"; }), "maxdepth");
    expect(with([](RenderRequest& r) { r.photon_map = "bvh"; }), "\"path\" does not use a photon map");
    expect(with([](RenderRequest& r) { r.sampler = "halton"; }), "unknown sampler \"halton\"");
    expect(with([](RenderRequest& r) { r.limits.passes = 0; }), "must be at least 1");
    expect(with([](RenderRequest& r) { r.limits.seconds = 0.0; }), "above 0 seconds");
    expect(with([](RenderRequest& r) { r.replay = {12, 0, 0}; }), "12x8 pixels");
    expect(with([](RenderRequest& r) { r.build.resolution = {0, 8}; }), "sides are 1 to");
    expect(with([](RenderRequest& r) { r.scene = SceneSource::of_file("/none.pbrt"); }), "/none.pbrt");
}

// Photon maps keep state from pass to pass; other integrators have none.
class Interrupted : public testing::TestWithParam<const char*> {};

TEST_P(Interrupted, TheImageIsWhatWasDone) {
    Listener listener;
    listener.interrupt_at(4);
    const RenderOutcome outcome = render(request_of(GetParam(), 1000000), listener);
    EXPECT_EQ(outcome.record.ended, RenderEnd::kInterrupted);
    EXPECT_EQ(outcome.record.progress.passes, 4u);
    EXPECT_EQ(outcome.image.pixels, render(request_of(GetParam(), 4)).image.pixels);
}

TEST_P(Interrupted, TheNextRunIsWhole) {
    const std::vector<float> whole = render(request_of(GetParam())).image.pixels;
    Listener listener;
    listener.interrupt_at(2);
    Rendering rendering(request_of(GetParam()), listener);
    EXPECT_EQ(rendering.run().record.ended, RenderEnd::kInterrupted);
    const RenderOutcome again = rendering.run();
    EXPECT_EQ(again.record.ended, RenderEnd::kPasses);
    EXPECT_EQ(again.image.pixels, whole);
    listener.interrupt_at(2);
    EXPECT_EQ(render(request_of(GetParam()), listener).record.ended, RenderEnd::kInterrupted);
    EXPECT_EQ(render(request_of(GetParam()), listener).image.pixels, whole);
}

INSTANTIATE_TEST_SUITE_P(Integrators, Interrupted,
                         testing::Values("path", "sppm:photonsperiteration=500", "photon_map:photons=500"),
                         [](const auto& info) {
                             const std::string name = info.param;
                             return name.substr(0, name.find(':'));
                         });

TEST(Render, AnInterruptionBeforeItBeginsLeavesABlackImage) {
    Listener listener;
    listener.interrupt();
    const RenderOutcome outcome = render(request_of(), listener);
    EXPECT_EQ(outcome.record.ended, RenderEnd::kInterrupted);
    EXPECT_EQ(outcome.record.progress.passes, 0u);
    EXPECT_EQ(outcome.image.at(6, 2, 0), 0.0f);
}

TEST(Render, AnyThreadMayInterrupt) {
    Listener listener;
    RenderRequest request = request_of();
    request.limits.passes.reset();
    request.limits.seconds = 60.0;
    std::thread other;
    listener.on_progress = [&](const RenderProgress& progress) {
        if (progress.passes == 1) other = std::thread([&listener] { listener.interrupt(); });
    };
    const RenderOutcome outcome = render(request, listener);
    other.join();
    EXPECT_EQ(outcome.record.ended, RenderEnd::kInterrupted);
    EXPECT_LT(outcome.record.progress.wall_s, 30.0);
}

TEST(Render, AnObserversExceptionComesOut) {
    Listener listener;
    Rendering rendering(request_of(), listener);
    listener.on_progress = [](const RenderProgress&) { throw std::runtime_error("enough"); };
    EXPECT_THROW(rendering.run(), std::runtime_error);
    listener.on_progress = nullptr;
    EXPECT_EQ(rendering.run().image.pixels, render(request_of()).image.pixels);
}

TEST(Render, ARunOfAnotherSeedIsARequestOfAnotherSeed) {
    RenderRequest request = request_of();
    Rendering rendering(request);
    const RenderOutcome first = rendering.run(), second = rendering.run(77);
    request.seed = 77;
    EXPECT_EQ(second.record.seed, 77u);
    EXPECT_EQ(second.image.pixels, render(request).image.pixels);
    EXPECT_NE(second.image.pixels, first.image.pixels);
}

TEST(Render, MoreEffectsThanTheSceneAsksForChangeNothing) {
    RenderRequest request = request_of();
    const RenderOutcome plain = render(request);
    request.effects = kernel::kAllEffects;
    const RenderOutcome all = render(request);
    EXPECT_LT(plain.record.effects.size(), known_effects().size());
    EXPECT_EQ(all.record.effects.size(), known_effects().size());
    EXPECT_EQ(all.image.pixels, plain.image.pixels);
}

// On Vulkan, shaders of two threads are compiled at once, too.
class TwoThreads : public testing::TestWithParam<std::string> {};

TEST_P(TwoThreads, RenderAsEachAlone) {
    std::vector<RenderRequest> requests{request_of("ao", 64), request_of("ao:distance=1", 64)};
    if (GetParam() != "vulkan") {  // whose drivers take half a minute for these
        requests.push_back(request_of("path", 64));
        requests.push_back(request_of("sppm:photonsperiteration=500", 32));
    }
    std::vector<std::vector<float>> alone, together(requests.size());
    for (RenderRequest& request : requests) {
        request.backend = GetParam();
        alone.push_back(render(request).image.pixels);
    }
    std::vector<std::thread> threads;
    for (size_t i = 0; i < requests.size(); ++i)
        threads.emplace_back([&, i] { together[i] = render(requests[i]).image.pixels; });
    for (std::thread& thread : threads) thread.join();
    for (size_t i = 0; i < requests.size(); ++i) EXPECT_EQ(together[i], alone[i]) << requests[i].integrator;
}

TEST_P(TwoThreads, AnInterruptionIsOfOneAlone) {
    RenderRequest request = request_of("ao", 32);
    request.backend = GetParam();
    Listener interrupted;
    interrupted.interrupt();
    RenderOutcome other;
    std::thread thread([&] { other = render(request); });
    const RenderOutcome outcome = render(request, interrupted);
    thread.join();
    EXPECT_EQ(outcome.record.ended, RenderEnd::kInterrupted);
    EXPECT_EQ(other.record.ended, RenderEnd::kPasses);
}

INSTANTIATE_TEST_SUITE_P(Backends, TwoThreads, testing::ValuesIn(usable_backends()), [](const auto& info) {
    std::string name = info.param;
    std::erase(name, '-');
    return name;
});

// The statements of docs/stats.md about each; add new integrators here.
TEST(ErrorRateOf, EachIntegratorIsWhatTheorySays) {
    const std::map<std::string, ErrorRate> expected = {
        {"path", ErrorRate::of_samples()},    {"ao", ErrorRate::of_samples()},
        {"light", ErrorRate::of_samples()},   {"bdpt", ErrorRate::of_samples()},
        {"mlt", ErrorRate::of_samples()},     {"vcm", ErrorRate::of_photons(0.75)},
        {"bpm", ErrorRate::of_photons(0.75)}, {"sppm", ErrorRate::of_photons(0.25)},
        {"ppm", ErrorRate::of_photons(0.25)}, {"photon_map", ErrorRate::of_photons(1.0)}};
    for (const std::string& name : integrators().names()) {
        SCOPED_TRACE(name);
        ASSERT_TRUE(expected.contains(name));
        const IntegratorFactory& factory = integrators().require(name);
        const std::unique_ptr<Integrator> integrator = factory.create();
        set_defaults(integrator->parameters(), factory.fields);
        if (name == "sppm" || name == "ppm") static_cast<ProgressiveParams*>(integrator->parameters())->alpha = 0.25f;
        EXPECT_EQ(integrator->error_rate().expected, expected.at(name).expected);
        EXPECT_EQ(integrator->error_rate().slowest, expected.at(name).slowest);
    }
}

}  // namespace
}  // namespace lampyris::test

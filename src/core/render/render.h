// The front door of the library: a scene in; an image, its error and its cost out. The program, the tests and the benchmarks
// render through it; docs/library.md shows how other programs do.
//
//     RenderRequest request;
//     request.scene = SceneSource::of_text(text);
//     request.limits.passes = 16;
//     const RenderOutcome outcome = render(request);
//
// Nothing is printed. Failures are exceptions of core/base/error.h: an InputError with all errors of the scene or the request, or a
// MachineError for what the machine cannot do.
#pragma once

#include "core/base/watch.h"
#include "core/device/device.h"
#include "core/image/image.h"
#include "core/render/path_log.h"
#include "core/render/run_record.h"
#include "core/scene/load.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lampyris {

// Members that are left at their defaults take the scene's values.
struct RenderRequest {
    SceneSource scene;
    BuildOptions build;             // resolution, crop and media; override the scene's
    bool skip_unsupported = false;  // ignore features that are not simulated, with a warning, instead of failing

    std::string integrator;  // "sppm:alpha=0.5,maxdepth=8"
    std::vector<std::pair<std::string, std::string>>
        integrator_settings;             // further settings, for whichever integrator renders
    std::string photon_map;              // "stochastic_hash:slots=2"
    std::optional<std::string> sampler;  // "independent" or "sobol"
    std::optional<uint32_t> seed;

    std::string backend = "cpu";
    DeviceOptions device_options;
    std::shared_ptr<Device> device;  // an existing device, instead of those two

    // The first limit reached ends the rendering; without limits, it ends after the scene's samples per pixel.
    BudgetLimits limits;
    // The same as limits.passes, except for integrators whose passes share their eye samples: there it is the number of those.
    std::optional<uint32_t> samples_per_pixel;

    std::string reference;             // an image file: the convergence then includes the error against it
    std::string checkpoint;            // a file that is kept up to date, so that nothing is lost (docs/checkpoints.md)
    double checkpoint_every_s = 60.0;  // and at the end
    bool resume = false;               // go on from the checkpoint, if there is one
    std::optional<std::array<int, 3>> replay;  // x, y, pass: one sample of one pixel, alone
    uint64_t first_pass = 0;                   // number of the first pass
    // Most bytes of memory for the process: MachineError if it has more once the scene is loaded, or after a pass, and
    // RenderObserver::fails_after gets the image so far. device_options.max_memory limits buffers before they are made. 0: no limit.
    uint64_t max_process_memory = 0;
    uint32_t max_slice = 0;  // maximum of passes in a slice; 0: as many as take a fraction of a second
    uint64_t effects = 0;    // effects that kernels support beyond the scene's, so that one build serves many scenes
};

// What is about to be rendered.
struct RenderPlan {
    const Scene& scene;
    const SceneSettings& settings;  // as the request changes them
    const BudgetLimits& limits;     // the limits in force
};

struct RenderOutcome {
    // R, G, B, the features that docs/images.md lists, and its provenance as metadata. If the rendering was interrupted during
    // the first pass (record.progress.passes is 0), the image is black or incomplete.
    Image image;
    RunRecord record;
    std::vector<kernel::FilmPixel> pixels;  // the sums behind the image
    PathLog paths;                          // of a replay
};

// Receives events while a scene is rendered, in the rendering thread, and may interrupt it (Watch::interrupt). An exception
// thrown here ends the rendering and is passed on by render(). An observer serves one rendering at a time.
class RenderObserver : public Watch {
 public:
    // A warning about the scene: formatted, with the location in its file. Errors are thrown afterwards.
    virtual void warning([[maybe_unused]] const std::string& text) {}
    // Something in the scene was mapped or ignored, and the user should know.
    virtual void note([[maybe_unused]] const std::string& text) {}
    // Something that was asked for could not be done, and the rendering goes on.
    virtual void failure([[maybe_unused]] const std::string& text) {}
    // The scene has been read and is correct; no device is working yet.
    virtual void ready([[maybe_unused]] const RenderPlan& plan) {}
    // After each slice of passes that ends at a power of two, after the last one, and at least every two seconds.
    virtual void progress([[maybe_unused]] const RenderProgress& progress, [[maybe_unused]] const Film& film) {}
    // What there is after so many seconds, and so on, without `pixels`: for a picture to look at meanwhile. 0: none.
    virtual double wants_image_every() const { return 0.0; }
    virtual void image_so_far([[maybe_unused]] const RenderOutcome& outcome) {}
    // No pass is rendered any more; what there is becomes the outcome.
    virtual void passes_end() {}
    // The rendering fails: what there was at the last progress(), without `pixels`. render() throws afterwards.
    virtual void fails_after([[maybe_unused]] const RenderOutcome& outcome) {}

    // What there was at the last progress(), without `pixels` and layers; nothing before that, and after passes_end(). For other
    // threads: the rendering thread may be in a driver's compiler for minutes, or wait for a device that hangs. `patience` is for
    // the moments in which the film is read. `ends`: the program is about to end, so the checkpoint is written, too, if there is one.
    std::optional<RenderOutcome> outcome_so_far(std::chrono::milliseconds patience, bool ends = false);

 private:
    friend class Rendering;
    using SoFar = std::function<std::optional<RenderOutcome>(std::chrono::milliseconds, bool)>;
    void let_ask(SoFar so_far);
    std::mutex so_far_mutex_;
    SoFar so_far_;
};

RenderOutcome render(const RenderRequest& request);
RenderOutcome render(const RenderRequest& request, RenderObserver& observer);

// The same in two steps, for a scene that is rendered more than once: the constructor reads it, builds it and loads it onto the
// device. Each run starts afresh, however the one before ended.
class Rendering {
 public:
    explicit Rendering(RenderRequest request);
    Rendering(RenderRequest request, RenderObserver& observer);  // the observer must outlive it
    ~Rendering();
    Rendering(const Rendering&) = delete;
    Rendering& operator=(const Rendering&) = delete;

    RenderOutcome run();
    RenderOutcome run(uint32_t seed);  // overrides the seeds of request and scene

    const Scene& scene() const;
    const SceneSettings& settings() const;

 private:
    struct State;
    struct Run;
    std::unique_ptr<State> state_;
};

}  // namespace lampyris

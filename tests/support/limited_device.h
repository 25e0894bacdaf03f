// A device that ends a kernel's loops early, as Mesa before 25 does: after a number of samples in one run.
#pragma once

#include "core/base/error.h"
#include "core/device/device.h"
#include "core/device/kernel_types.h"

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lampyris::test {

// Runs everything on another device. A kernel that takes samples of pixels runs completely, so that the film is modified; if it
// was to take more than `most` samples, it is then reported as unfinished.
class LimitedDevice final : public Device {
 public:
    LimitedDevice(std::shared_ptr<Device> inner, uint32_t most, uint32_t& failures)
        : inner_(std::move(inner)), most_(most), failures_(failures) {}

    std::string backend() const override { return inner_->backend(); }
    std::string description() const override { return inner_->description(); }
    unsigned threads() const override { return inner_->threads(); }
    bool offers(DeviceFeature feature) const override {
        return feature != DeviceFeature::kLongLoops && inner_->offers(feature);
    }
    BufferHandle create_buffer(size_t bytes, std::string_view name) override {
        return inner_->create_buffer(bytes, name);
    }
    DeviceSceneHandle upload(const Scene& scene) override { return inner_->upload(scene); }
    KernelHandle compile(std::string_view file, uint64_t effects) override {
        KernelHandle kernel = inner_->compile(file, effects);
        for (const char* sampling : {"ao/ao.radiance.h", "path/path.radiance.h", "photon_paths/eye_pass.kernel.h"})
            if (file.ends_with(sampling)) sampling_[kernel.get()] = std::string(file);
        return kernel;
    }
    void run(const Kernel& kernel, const DeviceScene* scene, std::span<const NamedBuffer> buffers, uint32_t begin,
             uint32_t count) override {
        inner_->run(kernel, scene, buffers, begin, count);
        const auto found = sampling_.find(&kernel);
        if (found == sampling_.end() || count == 0) return;
        kernel::FilmWindow window{};
        for (const NamedBuffer& buffer : buffers)
            if (buffer.name == "window") buffer.buffer->download(&window, sizeof window);
        if (window.samples <= most_) return;
        ++failures_;
        throw UnfinishedError("error: kernel " + found->second + " could not finish a loop within its bound");
    }
    DeviceStatistics statistics() const override { return inner_->statistics(); }

 private:
    std::shared_ptr<Device> inner_;
    const uint32_t most_;
    uint32_t& failures_;
    std::map<const Kernel*, std::string> sampling_;
};

}  // namespace lampyris::test

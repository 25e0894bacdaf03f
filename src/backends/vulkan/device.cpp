// The Vulkan backend: kernels through glslang, on any device with Vulkan 1.2.
#include "backends/vulkan/boxes.h"
#include "backends/vulkan/kernel.h"
#include "backends/vulkan/scene.h"
#include "core/base/error.h"
#include "core/base/watch.h"
#include "core/scene/scene.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <limits>

namespace lampyris::vulkan {
namespace {

using Clock = std::chrono::steady_clock;

constexpr uint64_t kLeastBinding = 16;  // large enough that the flag of unfinished loops stays bound

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

class VulkanDevice final : public Device {
 public:
    explicit VulkanDevice(const DeviceOptions& options)
        : context_(std::make_shared<Context>(options)),
          account_(std::make_shared<MemoryAccount>()),
          cache_(read_cache_folder(options)) {
        check_settings("vulkan", options,
                       {"cache", "exact", "max_binding", "optimize", "precise", "ray_query", "specialise", "staging",
                        "validation", "wide_reads", "workgroup"});
        account_->limit = options.max_memory;
        context_->can.max_storage_range = std::min(context_->can.max_storage_range, largest_binding(options));
        shader_options_.precise = read_switch(options, "precise", Switch::on) != Switch::off;
        const Switch optimize = read_switch(options, "optimize", Switch::automatic);
        shader_options_.optimize = optimize != Switch::off;
        // A CPU driver compiles a shader with function calls in less time than one that was inlined before (docs/backends.md).
        shader_options_.inlined = optimize == Switch::on || (optimize == Switch::automatic && !context_->can.is_cpu);
        shader_options_.local_size = workgroup_size(options);
        specialise_ = read_switch(options, "specialise", Switch::on) != Switch::off;
        const Switch staging = read_switch(options, "staging", Switch::automatic);
        staged_ = staging == Switch::on || (staging == Switch::automatic && !context_->can.has_host_visible_local);
        const Switch ray_query = read_switch(options, "ray_query", Switch::automatic);
        if (ray_query == Switch::on && !context_->can.ray_query) {
            throw MachineError(fmt::format("error: backend.ray_query=on: {} ({}) does not offer VK_KHR_ray_query",
                                           context_->name, context_->driver));
        }
        // A CPU driver's ray tracing is slower than the BVH2 in the shader (measured: see docs/backends.md).
        shader_options_.ray_query = ray_query == Switch::on || (ray_query == Switch::automatic &&
                                                                context_->can.ray_query && !context_->can.is_cpu);
        const Switch wide_reads = read_switch(options, "wide_reads", Switch::automatic);
        if (wide_reads == Switch::on && !context_->can.int64) {
            throw MachineError(fmt::format("error: backend.wide_reads=on: {} ({}) has no integers of 64 bits",
                                           context_->name, context_->driver));
        }
        shader_options_.wide_reads = wide_reads == Switch::on ||
                                     (wide_reads == Switch::automatic && context_->can.int64 && context_->can.is_cpu);
        unfinished_ = std::make_unique<VulkanBuffer>(context_, account_, sizeof(uint32_t), "the unfinished flag",
                                                     BufferOptions{.read_back = true});
        unfinished_->fill_zero();
        no_scene_.buffers[kernel::BINDING_UNFINISHED] = unfinished_->binding();
        no_scene_.buffers[kernel::BINDING_PATH_LOG] = unfinished_->binding();  // anything: nothing is written there
        // CPU drivers divide with the CPU's instructions, which round as IEEE 754 specifies.
        const Switch exact = read_switch(options, "exact", Switch::off);
        shader_options_.exact = exact == Switch::on || (exact == Switch::automatic && !context_->can.is_cpu);
        shader_options_.flush_denormals = shader_options_.exact && context_->can.flushes_denormals;
        context_->check_validation();
    }

    std::string backend() const override { return "vulkan"; }
    std::string description() const override {
        return fmt::format("{}, {}{}", context_->name, context_->driver,
                           shader_options_.ray_query ? ", ray query" : "");
    }
    unsigned threads() const override { return 0; }
    bool offers(DeviceFeature feature) const override {
        switch (feature) {
            case DeviceFeature::kInt64Atomics: return context_->can.int64_atomics;
            case DeviceFeature::kRayQuery: return shader_options_.ray_query;
            case DeviceFeature::kBoxes: return context_->can.ray_query;
            case DeviceFeature::kLongLoops: return !context_->can.ends_loops;
        }
        return false;
    }

    BufferHandle create_buffer(size_t bytes, std::string_view name) override {
        BufferOptions options{.staged = staged_};
        if (context_->can.ray_query) options.usage |= kBuildInputUsage;  // it may be used for boxes later
        auto buffer = std::make_shared<VulkanBuffer>(context_, account_, bytes, name, options);
        guarded("clearing a buffer", [&] { buffer->fill_zero(); });
        return buffer;
    }

    DeviceSceneHandle upload(const Scene& scene) override {
        const auto start = Clock::now();
        DeviceSceneHandle result;
        guarded("uploading the scene", [&] {
            result = std::make_shared<VulkanScene>(context_, account_, scene, staged_, shader_options_.ray_query,
                                                   *unfinished_);
        });
        statistics_.build_s += seconds_since(start);
        return result;
    }

    KernelHandle compile(std::string_view file, uint64_t effects) override {
        const auto start = Clock::now();
        const CompileNotice notice(file);
        shaders::ShaderOptions options = shader_options_;
        options.effects = specialise_ ? effects : effects | kernel::kAllEffects;
        options.names = !find_kernel_buffers(file).has_value();
        shaders::CompiledShader shader = shaders::compile_shader(file, options, cache_);
        std::shared_ptr<VulkanKernel> kernel;
        guarded(fmt::format("compiling kernel {}", file), [&] {
            kernel = std::make_shared<VulkanKernel>(context_, std::string(file), std::move(shader), options.local_size);
            // If some buffers are too large to bind, the first run shows which, and compiles the kernel. Nothing is compiled
            // twice.
            if (!kernel->uses_acceleration_structure() && account_->too_large_to_bind == 0)
                kernel->prepare(no_scene_, unfinished_->handle());
        });
        const double seconds = seconds_since(start);
        statistics_.compile_s += seconds;
        statistics_.spirv_bytes[std::string(file)] = kernel->spirv_bytes();
        spdlog::debug("kernel {}: {} bytes of SPIR-V {}, ready after {:.2f} s", file, kernel->spirv_bytes(),
                      kernel->from_cache() ? "from the cache" : "compiled", seconds);
        return kernel;
    }

    void run(const Kernel& kernel, const DeviceScene* scene, std::span<const NamedBuffer> buffers, uint32_t begin,
             uint32_t count) override {
        const auto& vulkan_kernel = dynamic_cast<const VulkanKernel&>(kernel);
        if (!scene && vulkan_kernel.uses_scene())
            throw std::logic_error(fmt::format("kernel {} needs a scene", vulkan_kernel.file()));
        const std::vector<BufferHandle> bound = vulkan_kernel.bind(buffers);
        std::vector<KernelBinding> handles(bound.size());
        for (size_t i = 0; i < bound.size(); ++i) {
            if (!bound[i]) continue;
            const auto& buffer = dynamic_cast<const VulkanBuffer&>(*bound[i]);
            handles[i] = buffer.binding();
            if (buffer.boxes) handles[i].structure = buffer.boxes->top_level();
        }
        guarded(fmt::format("running kernel {}", vulkan_kernel.file()), [&] {
            SceneBindings bindings = scene ? dynamic_cast<const VulkanScene&>(*scene).bindings() : no_scene_;
            if (const BufferHandle& log = path_log())
                bindings.buffers[kernel::BINDING_PATH_LOG] = dynamic_cast<const VulkanBuffer&>(*log).binding();
            const VulkanKernel::Spent spent =
                vulkan_kernel.run(bindings, handles, begin, count, [&] { return is_unfinished(); });
            statistics_.compile_s += spent.compile_s;
            statistics_.kernel_s[vulkan_kernel.file()] += spent.kernel_s;
            check_unfinished(vulkan_kernel.file());
        });
    }

    size_t build_boxes(const BufferHandle& boxes, uint32_t count) override {
        if (!context_->can.ray_query) return Device::build_boxes(boxes, count);
        if (count > context_->can.max_boxes)
            throw MachineError(
                fmt::format("error: Vulkan: {} builds acceleration structures of at most {} boxes, not {}",
                            context_->name, context_->can.max_boxes, count));
        const auto start = Clock::now();
        auto& buffer = dynamic_cast<VulkanBuffer&>(*boxes);
        buffer.check_range(size_t(count) * sizeof(vk::AabbPositionsKHR), 0);
        size_t bytes = 0;
        guarded("building an acceleration structure over boxes", [&] {
            if (!buffer.boxes) buffer.boxes = std::make_shared<BoxStructure>(context_, account_, staged_);
            bytes = buffer.boxes->build(buffer.address(), count);
        });
        statistics_.kernel_s["(structure over boxes)"] += seconds_since(start);
        return bytes;
    }

    DeviceStatistics statistics() const override {
        DeviceStatistics result = statistics_;
        result.memory_bytes = account_->used;
        result.peak_memory_bytes = account_->peak;
        return result;
    }

    std::vector<std::string> provoke() {
        if (!context_->validation) return {};
        try {
            const vk::raii::Buffer wrong(context_->device,
                                         {{}, 0, vk::BufferUsageFlagBits::eStorageBuffer, vk::SharingMode::eExclusive});
        } catch (const vk::Error&) {}
        return context_->validation_log.take();
    }

 private:
    static uint64_t largest_binding(const DeviceOptions& options) {
        const auto found = options.settings.find("max_binding");
        if (found == options.settings.end()) return std::numeric_limits<uint64_t>::max();
        uint64_t bytes = 0;
        const std::string& text = found->second;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bytes);
        if (error != std::errc() || end != text.data() + text.size() || bytes < kLeastBinding)
            throw InputError(fmt::format("error: --set backend.max_binding={}: valid is a number of bytes, {} or more",
                                         text, kLeastBinding));
        return bytes;
    }

    static uint32_t workgroup_size(const DeviceOptions& options) {
        const auto found = options.settings.find("workgroup");
        if (found == options.settings.end()) return shaders::ShaderOptions().local_size;
        for (const uint32_t size : {8u, 16u, 32u, 64u, 128u, 256u}) {
            if (found->second == std::to_string(size)) return size;
        }
        throw InputError(
            fmt::format("error: --set backend.workgroup={}: valid are 8, 16, 32, 64, 128 and 256", found->second));
    }

    // Turns Vulkan's errors, and messages of the validation layers, into errors that users can act on.
    template <typename Work>
    void guarded(const std::string& doing, Work&& work) {
        try {
            work();
        } catch (const vk::Error& error) {
            throw MachineError(explain(error, doing));
        }
        if (context_->validation) context_->check_validation();
    }

    bool is_unfinished() const {
        uint32_t flag = 0;
        unfinished_->download(&flag, sizeof flag, 0);
        return flag != 0;
    }

    void check_unfinished(const std::string& file) {
        if (!is_unfinished()) return;
        unfinished_->fill_zero();
        throw UnfinishedError(
            fmt::format("error: kernel {} could not finish a loop within its bound: the driver ended the loop early, "
                        "or a stack was too small. The image would be wrong. Mesa before version 25 ends loops after "
                        "65,535 iterations; long paths, many rays per sample or many photons within a radius need "
                        "more. Use a newer driver or --backend cpu",
                        file));
    }

    std::shared_ptr<Context> context_;
    std::shared_ptr<MemoryAccount> account_;
    shaders::ShaderCache cache_;
    shaders::ShaderOptions shader_options_;
    bool staged_ = false;
    bool specialise_ = true;
    std::unique_ptr<VulkanBuffer> unfinished_;
    SceneBindings no_scene_;
    DeviceStatistics statistics_;
};

const BackendRegistration vulkan(
    "vulkan", "kernels as compute shaders on any Vulkan 1.2 device",
    [](const DeviceOptions& options) { return std::make_unique<VulkanDevice>(options); }, list_vulkan_devices);

}  // namespace

std::vector<std::string> provoke_validation_message(Device& device) {
    auto* vulkan_device = dynamic_cast<VulkanDevice*>(&device);
    return vulkan_device ? vulkan_device->provoke() : std::vector<std::string>();
}

}  // namespace lampyris::vulkan

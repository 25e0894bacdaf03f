#include "backends/vulkan/kernel.h"

#include "core/base/watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <stdexcept>

namespace lampyris::vulkan {
namespace {

constexpr double kDispatchSeconds = 0.1;  // target; watchdogs trip at two seconds and more
constexpr uint32_t kFirstChunk = 4096;    // indices of the first dispatch, whose speed is not known yet

// The buffers of set 1 that the module uses.
std::vector<KernelBuffer> named_buffers(const Spirv& spirv) {
    std::vector<KernelBuffer> buffers;
    for (const ShaderBinding& binding : shaders::used_bindings(spirv))
        if (binding.set == 1) buffers.push_back({binding.binding, binding.name, 0});
    return buffers;
}

}  // namespace

VulkanKernel::VulkanKernel(std::shared_ptr<Context> context, const std::string& file, CompiledShader shader,
                           uint32_t local_size)
    : Kernel(file, named_buffers(shader.spirv)),
      context_(std::move(context)),
      shader_(std::move(shader)),
      local_size_(local_size),
      bindings_(shaders::used_bindings(shader_.spirv)) {}

bool VulkanKernel::uses_acceleration_structure() const {
    return std::any_of(bindings_.begin(), bindings_.end(), [](const auto& b) { return b.acceleration_structure; });
}

bool VulkanKernel::uses_scene() const {
    return std::any_of(bindings_.begin(), bindings_.end(),
                       [](const auto& b) { return b.set == 0 && b.binding != kernel::BINDING_UNFINISHED; });
}

KernelPipeline& VulkanKernel::pipeline(const SceneBindings& scene, std::span<const KernelBinding> buffers,
                                       bool tell) const {
    std::vector<KernelBinding> given(bindings_.size());
    Addressed addressed(bindings_.size());
    for (size_t i = 0; i < bindings_.size(); ++i) {
        const ShaderBinding& binding = bindings_[i];
        if (binding.set == 1 && binding.binding < buffers.size()) given[i] = buffers[binding.binding];
        if (binding.set == 0 && binding.binding < scene.buffers.size()) given[i] = scene.buffers[binding.binding];
        if (binding.set == 0 && binding.acceleration_structure) given[i].structure = scene.top_level;
        if (binding.acceleration_structure ? !given[i].structure : !given[i].buffer)
            throw std::logic_error(fmt::format("kernel {} uses set {}, binding {}, which run() was not given", file(),
                                               binding.set, binding.binding));
        addressed[i] = !binding.acceleration_structure && given[i].address != 0;
    }
    std::unique_ptr<KernelPipeline>& kept = pipelines_[addressed];
    const bool is_new = !kept;
    std::optional<CompileNotice> notice;
    if (is_new && tell) notice.emplace(file());
    if (is_new)
        kept = std::make_unique<KernelPipeline>(context_, file(), shader_.spirv, bindings_, addressed, local_size_);
    kept->bind(given);
    if (is_new) kept->dispatch(0, 0);  // some drivers (lavapipe) compile at the first dispatch, so do it now
    return *kept;
}

VulkanKernel::Spent VulkanKernel::run(const SceneBindings& scene, std::span<const KernelBinding> buffers,
                                      uint32_t begin, uint32_t count, const std::function<bool()>& stop) const {
    Spent spent;
    const auto start = std::chrono::steady_clock::now();
    const size_t pipelines = pipelines_.size();
    KernelPipeline& chosen = pipeline(scene, buffers, true);
    if (pipelines_.size() > pipelines)
        spent.compile_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto most = static_cast<uint32_t>(
        std::min<uint64_t>(uint64_t(context_->can.max_groups) * local_size_, UINT32_MAX - local_size_));
    if (chunk_ == 0) chunk_ = kFirstChunk;
    for (uint32_t done = 0; done < count;) {
        current_watch().check_cancelled();
        const uint32_t piece = std::min({count - done, chunk_, most});
        const double seconds = chosen.dispatch(begin + done, piece);
        spent.kernel_s += seconds;
        done += piece;
        // Approaches kDispatchSeconds. A short last piece says little about speed, so only full pieces let the size grow.
        const double ratio = std::clamp(kDispatchSeconds / std::max(seconds, 1e-6), 0.1, 8.0);
        if (piece == chunk_ || ratio < 1)
            chunk_ = static_cast<uint32_t>(std::clamp(double(piece) * ratio, double(local_size_), double(most)));
        if (stop()) break;
    }
    return spent;
}

void VulkanKernel::prepare(const SceneBindings& scene, vk::Buffer anything) const {
    SceneBindings stand_in = scene;
    for (KernelBinding& buffer : stand_in.buffers) buffer = {anything, {}, 0};
    const std::vector<KernelBinding> buffers(64, KernelBinding{anything, {}, 0});
    pipeline(stand_in, buffers, false);  // the caller has announced the compilation
}

}  // namespace lampyris::vulkan

#include "backends/vulkan/kernel.h"

#include "core/error.h"
#include "core/watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

namespace lampyris::vulkan {
namespace {

constexpr double kDispatchSeconds = 0.1;  // aimed at; watchdogs trip at two seconds and more
constexpr uint32_t kFirstChunk = 4096;    // indices of the first dispatch, when nothing is known yet
constexpr uint32_t kSets = 2;

struct KernelRange {
    uint32_t begin, count;
};

vk::DescriptorType type_of(const ShaderBinding& binding) {
    return binding.acceleration_structure ? vk::DescriptorType::eAccelerationStructureKHR
                                          : vk::DescriptorType::eStorageBuffer;
}

}  // namespace

VulkanKernel::VulkanKernel(std::shared_ptr<Context> context, std::string file, const CompiledShader& shader,
                           uint32_t local_size)
    : context_(std::move(context)),
      file_(std::move(file)),
      spirv_bytes_(shader.spirv.size() * sizeof(uint32_t)),
      from_cache_(shader.from_cache),
      local_size_(local_size),
      bindings_(used_bindings(shader.spirv)) {
    const vk::raii::Device& device = context_->device;
    uint32_t storage_buffers = 0, structures = 0;
    for (uint32_t set = 0; set < kSets; ++set) {
        std::vector<vk::DescriptorSetLayoutBinding> entries;
        for (const ShaderBinding& binding : bindings_) {
            if (binding.set >= kSets)
                throw std::logic_error(fmt::format("kernel {} uses descriptor set {}", file_, binding.set));
            if (binding.set != set) continue;
            entries.emplace_back(binding.binding, type_of(binding), 1, vk::ShaderStageFlagBits::eCompute);
            (binding.acceleration_structure ? structures : storage_buffers) += 1;
        }
        set_layouts_.emplace_back(device, vk::DescriptorSetLayoutCreateInfo({}, entries));
    }
    if (storage_buffers > context_->can.max_storage_buffers) {
        throw MachineError(fmt::format("error: Vulkan: kernel {} reads {} buffers, and {} binds at most {}", file_,
                                       storage_buffers, context_->name, context_->can.max_storage_buffers));
    }
    std::vector<vk::DescriptorSetLayout> layouts;
    for (const auto& layout : set_layouts_) layouts.push_back(*layout);
    const vk::PushConstantRange range(vk::ShaderStageFlagBits::eCompute, 0, sizeof(KernelRange));
    layout_ = vk::raii::PipelineLayout(device, vk::PipelineLayoutCreateInfo({}, layouts, range));
    const vk::raii::ShaderModule module(device, vk::ShaderModuleCreateInfo({}, shader.spirv));
    const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main");
    pipeline_ = vk::raii::Pipeline(device, nullptr, vk::ComputePipelineCreateInfo({}, stage, *layout_));

    std::vector<vk::DescriptorPoolSize> sizes{{vk::DescriptorType::eStorageBuffer, std::max(storage_buffers, 1u)}};
    if (structures) sizes.emplace_back(vk::DescriptorType::eAccelerationStructureKHR, structures);
    pool_ = vk::raii::DescriptorPool(
        device, vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, kSets, sizes));
    vk::raii::DescriptorSets sets(device, vk::DescriptorSetAllocateInfo(*pool_, layouts));
    for (auto& set : sets) sets_.push_back(std::move(set));
    if (context_->can.timestamps) queries_ = vk::raii::QueryPool(device, {{}, vk::QueryType::eTimestamp, 2});
}

bool VulkanKernel::uses_acceleration_structure() const {
    return std::any_of(bindings_.begin(), bindings_.end(), [](const auto& b) { return b.acceleration_structure; });
}

bool VulkanKernel::uses_scene() const {
    return std::any_of(bindings_.begin(), bindings_.end(),
                       [](const auto& b) { return b.set == 0 && b.binding != kUnfinishedBinding; });
}

void VulkanKernel::bind(const SceneBindings& scene, std::span<const KernelBinding> buffers) const {
    std::vector<vk::WriteDescriptorSet> writes;
    std::vector<vk::DescriptorBufferInfo> infos;
    std::vector<vk::AccelerationStructureKHR> handles;
    std::vector<vk::WriteDescriptorSetAccelerationStructureKHR> structures;
    infos.reserve(bindings_.size());  // what the writes point to must stay where it is
    handles.reserve(bindings_.size());
    structures.reserve(bindings_.size());
    for (const ShaderBinding& binding : bindings_) {
        KernelBinding given;
        if (binding.set == 1 && binding.binding < buffers.size()) given = buffers[binding.binding];
        if (binding.set == 0 && binding.binding < scene.buffers.size())
            given = {scene.buffers[binding.binding], scene.top_level};
        if (binding.acceleration_structure ? !given.structure : !given.buffer)
            throw std::logic_error(fmt::format("kernel {} uses set {}, binding {}, which run() was not given", file_,
                                               binding.set, binding.binding));
        vk::WriteDescriptorSet write(*sets_[binding.set], binding.binding, 0, 1, type_of(binding));
        if (binding.acceleration_structure) {
            handles.push_back(given.structure);
            structures.emplace_back(1, &handles.back());
            write.setPNext(&structures.back());
        } else {
            infos.emplace_back(given.buffer, 0, VK_WHOLE_SIZE);
            write.setPBufferInfo(&infos.back());
        }
        writes.push_back(write);
    }
    context_->device.updateDescriptorSets(writes, {});
}

double VulkanKernel::dispatch(uint32_t begin, uint32_t count) const {
    const auto start = std::chrono::steady_clock::now();
    const bool timed = bool(*queries_);
    context_->submit([&](vk::raii::CommandBuffer& commands) {
        using Stage = vk::PipelineStageFlagBits;
        using Access = vk::AccessFlagBits;
        const vk::MemoryBarrier before(Access::eShaderWrite | Access::eTransferWrite | Access::eHostWrite,
                                       Access::eShaderRead | Access::eShaderWrite);
        commands.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer | Stage::eHost, Stage::eComputeShader, {},
                                 before, {}, {});
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline_);
        const std::array<vk::DescriptorSet, kSets> sets{*sets_[0], *sets_[1]};
        commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout_, 0, sets, {});
        commands.pushConstants<KernelRange>(*layout_, vk::ShaderStageFlagBits::eCompute, 0, KernelRange{begin, count});
        if (timed) {
            commands.resetQueryPool(*queries_, 0, 2);
            commands.writeTimestamp(Stage::eTopOfPipe, *queries_, 0);
        }
        commands.dispatch(std::max((count + local_size_ - 1) / local_size_, 1u), 1, 1);
        if (timed) commands.writeTimestamp(Stage::eBottomOfPipe, *queries_, 1);
        const vk::MemoryBarrier after(Access::eShaderWrite, Access::eHostRead | Access::eHostWrite |
                                                                Access::eTransferRead | Access::eTransferWrite);
        commands.pipelineBarrier(Stage::eComputeShader, Stage::eHost | Stage::eTransfer, {}, after, {}, {});
    });
    ++dispatches_;
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!timed) return wall;
    const auto [result, ticks] = queries_.getResults<uint64_t>(
        0, 2, 2 * sizeof(uint64_t), sizeof(uint64_t), vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    if (result != vk::Result::eSuccess || ticks[1] < ticks[0]) return wall;
    return std::min(double(ticks[1] - ticks[0]) * context_->can.timestamp_ns * 1e-9, wall);
}

double VulkanKernel::run(const SceneBindings& scene, std::span<const KernelBinding> buffers, uint32_t begin,
                         uint32_t count) const {
    if (count == 0) return 0;
    bind(scene, buffers);
    const auto most = static_cast<uint32_t>(
        std::min<uint64_t>(uint64_t(context_->can.max_groups) * local_size_, UINT32_MAX - local_size_));
    if (chunk_ == 0) chunk_ = kFirstChunk;
    double seconds = 0;
    for (uint32_t done = 0; done < count;) {
        check_cancelled();
        const uint32_t piece = std::min({count - done, chunk_, most});
        const double spent = dispatch(begin + done, piece);
        seconds += spent;
        done += piece;
        // Towards kDispatchSeconds; a short last piece says little, so only full ones let the size grow.
        const double ratio = std::clamp(kDispatchSeconds / std::max(spent, 1e-6), 0.1, 8.0);
        if (piece == chunk_ || ratio < 1)
            chunk_ = static_cast<uint32_t>(std::clamp(double(piece) * ratio, double(local_size_), double(most)));
    }
    return seconds;
}

void VulkanKernel::warm_up(const SceneBindings& scene, vk::Buffer anything) const {
    SceneBindings stand_in = scene;
    for (vk::Buffer& buffer : stand_in.buffers) buffer = anything;
    const std::vector<KernelBinding> buffers(64, KernelBinding{anything, {}});
    bind(stand_in, buffers);
    dispatch(0, 0);
}

}  // namespace lampyris::vulkan

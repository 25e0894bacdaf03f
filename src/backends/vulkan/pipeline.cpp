#include "backends/vulkan/pipeline.h"

#include "backends/vulkan/addresses.h"
#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

namespace lampyris::vulkan {
namespace {

vk::DescriptorType type_of(const ShaderBinding& binding) {
    return binding.acceleration_structure ? vk::DescriptorType::eAccelerationStructureKHR
                                          : vk::DescriptorType::eStorageBuffer;
}

}  // namespace

KernelPipeline::KernelPipeline(std::shared_ptr<Context> context, const std::string& file, const Spirv& spirv,
                               std::span<const ShaderBinding> bindings, const Addressed& addressed, uint32_t local_size)
    : context_(std::move(context)),
      local_size_(local_size),
      bindings_(bindings.begin(), bindings.end()),
      addressed_(addressed) {
    const vk::raii::Device& device = context_->device;
    std::vector<ShaderBinding> by_address;
    std::vector<vk::DescriptorSetLayoutBinding> entries[kSets];
    uint32_t storage_buffers = 0, structures = 0;
    for (size_t i = 0; i < bindings_.size(); ++i) {
        const ShaderBinding& binding = bindings_[i];
        if (binding.set >= kSets)
            throw std::logic_error(fmt::format("kernel {} uses descriptor set {}", file, binding.set));
        if (addressed_[i]) {
            by_address.push_back(binding);
            continue;
        }
        entries[binding.set].emplace_back(binding.binding, type_of(binding), 1, vk::ShaderStageFlagBits::eCompute);
        (binding.acceleration_structure ? structures : storage_buffers) += 1;
    }
    if (storage_buffers > context_->can.max_storage_buffers) {
        throw MachineError(fmt::format("error: Vulkan: kernel {} reads {} buffers, and {} binds at most {}", file,
                                       storage_buffers, context_->name, context_->can.max_storage_buffers));
    }
    addresses_.resize(by_address.size());
    const auto constant_bytes = uint32_t(sizeof(KernelRange) + by_address.size() * sizeof(vk::DeviceAddress));
    if (constant_bytes > context_->can.max_push_constants) {
        throw MachineError(fmt::format(
            "error: Vulkan: kernel {} reads {} buffers of more than {:.0f} MB, and {} supports at most {} of them",
            file, by_address.size(), double(context_->can.max_storage_range) / 1e6, context_->name,
            (context_->can.max_push_constants - sizeof(KernelRange)) / sizeof(vk::DeviceAddress)));
    }
    for (const auto& of_set : entries) set_layouts_.emplace_back(device, vk::DescriptorSetLayoutCreateInfo({}, of_set));
    std::vector<vk::DescriptorSetLayout> layouts;
    for (const auto& layout : set_layouts_) layouts.push_back(*layout);
    const vk::PushConstantRange range(vk::ShaderStageFlagBits::eCompute, 0, constant_bytes);
    layout_ = vk::raii::PipelineLayout(device, vk::PipelineLayoutCreateInfo({}, layouts, range));
    const Spirv changed = address_buffers(spirv, by_address);
    const vk::raii::ShaderModule module(device, vk::ShaderModuleCreateInfo({}, changed));
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

void KernelPipeline::bind(std::span<const KernelBinding> buffers) {
    std::vector<vk::WriteDescriptorSet> writes;
    std::vector<vk::DescriptorBufferInfo> infos;
    std::vector<vk::AccelerationStructureKHR> handles;
    std::vector<vk::WriteDescriptorSetAccelerationStructureKHR> structures;
    infos.reserve(bindings_.size());  // the writes point into these, so they must not be reallocated
    handles.reserve(bindings_.size());
    structures.reserve(bindings_.size());
    size_t addresses = 0;
    for (size_t i = 0; i < bindings_.size(); ++i) {
        const ShaderBinding& binding = bindings_[i];
        if (addressed_[i]) {
            addresses_[addresses++] = buffers[i].address;
            continue;
        }
        vk::WriteDescriptorSet write(*sets_[binding.set], binding.binding, 0, 1, type_of(binding));
        if (binding.acceleration_structure) {
            handles.push_back(buffers[i].structure);
            structures.emplace_back(1, &handles.back());
            write.setPNext(&structures.back());
        } else {
            infos.emplace_back(buffers[i].buffer, 0, VK_WHOLE_SIZE);
            write.setPBufferInfo(&infos.back());
        }
        writes.push_back(write);
    }
    context_->device.updateDescriptorSets(writes, {});
}

double KernelPipeline::dispatch(uint32_t begin, uint32_t count) {
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
        if (!addresses_.empty())
            commands.pushConstants<vk::DeviceAddress>(*layout_, vk::ShaderStageFlagBits::eCompute, sizeof(KernelRange),
                                                      addresses_);
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
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!timed) return wall;
    const auto [result, ticks] = queries_.getResults<uint64_t>(
        0, 2, 2 * sizeof(uint64_t), sizeof(uint64_t), vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    if (result != vk::Result::eSuccess || ticks[1] < ticks[0]) return wall;
    return std::min(double(ticks[1] - ticks[0]) * context_->can.timestamp_ns * 1e-9, wall);
}

}  // namespace lampyris::vulkan

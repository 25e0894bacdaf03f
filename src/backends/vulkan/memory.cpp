#include "backends/vulkan/memory.h"

#include "backends/vulkan/addresses.h"
#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace lampyris::vulkan {
namespace {

constexpr size_t kUpdateBytes = 65536;              // vkCmdUpdateBuffer takes no more
constexpr size_t kStagingBytes = size_t(16) << 20;  // large copies go through in pieces of this size

std::string mebibytes(uint64_t bytes) { return fmt::format("{:.1f} MiB", double(bytes) / (1024.0 * 1024.0)); }

}  // namespace

VulkanBuffer::VulkanBuffer(std::shared_ptr<Context> context, std::shared_ptr<MemoryAccount> account, size_t bytes,
                           std::string_view name, BufferOptions options)
    : context_(std::move(context)), account_(std::move(account)), name_(name), size_(bytes) {
    const size_t rounded =
        (std::max<size_t>(bytes, 16) + 15) / 16 * 16;  // fill works on words; a size of 0 is not allowed
    const Capabilities& can = context_->can;
    if (rounded > can.max_allocation) {
        throw MachineError(fmt::format(
            "error: Vulkan: {} allocates at most {} at once, and {} needs {}; --backend cpu has no such limit",
            context_->name, mebibytes(can.max_allocation), name_, mebibytes(rounded)));
    }
    if (account_->limit != 0 && account_->used + rounded > account_->limit) {
        throw MachineError(fmt::format("error: {} needs {}, which with {} in use is more than --max-memory {}", name_,
                                       mebibytes(rounded), mebibytes(account_->used), mebibytes(account_->limit)));
    }
    using Usage = vk::BufferUsageFlagBits;
    too_large_to_bind_ = (options.usage & Usage::eStorageBuffer) && rounded > can.max_storage_range;
    if (too_large_to_bind_ && !can.buffer_addresses)
        throw MachineError(
            fmt::format("error: Vulkan: {} binds at most {} to a buffer, offers no buffer addresses of 64 bits, and {} "
                        "needs {}; --backend cpu has no such limit",
                        context_->name, mebibytes(can.max_storage_range), name_, mebibytes(rounded)));
    if (too_large_to_bind_) options.usage |= Usage::eShaderDeviceAddress;
    using Memory = vk::MemoryPropertyFlagBits;
    try {
        buffer_ = vk::raii::Buffer(
            context_->device,
            {{}, rounded, options.usage | Usage::eTransferSrc | Usage::eTransferDst, vk::SharingMode::eExclusive});
        const auto needs = buffer_.getMemoryRequirements();
        const bool mapped = !options.staged;
        const uint32_t type =
            mapped ? context_->memory_type(needs.memoryTypeBits, Memory::eHostVisible | Memory::eHostCoherent,
                                           options.read_back ? Memory::eHostCached : Memory::eDeviceLocal)
                   : context_->memory_type(needs.memoryTypeBits, {}, Memory::eDeviceLocal);
        vk::MemoryAllocateFlagsInfo flags(vk::MemoryAllocateFlagBits::eDeviceAddress);
        vk::MemoryAllocateInfo info(needs.size, type);
        if (options.usage & Usage::eShaderDeviceAddress) info.setPNext(&flags);
        memory_ = vk::raii::DeviceMemory(context_->device, info);
        buffer_.bindMemory(*memory_, 0);
        if (mapped) mapped_ = memory_.mapMemory(0, VK_WHOLE_SIZE);
        allocated_ = needs.size;
    } catch (const vk::Error& error) {
        throw MachineError(explain(error, fmt::format("allocating {} for {}", mebibytes(rounded), name_)));
    }
    account_->used += allocated_;
    account_->peak = std::max(account_->peak, account_->used);
    account_->too_large_to_bind += too_large_to_bind_;
}

VulkanBuffer::~VulkanBuffer() {
    account_->used -= allocated_;
    account_->too_large_to_bind -= too_large_to_bind_;
    buffer_ = nullptr;  // before its memory
}

vk::DeviceAddress VulkanBuffer::address() const { return context_->device.getBufferAddress(*buffer_); }

KernelBinding VulkanBuffer::binding() const {
    if (!too_large_to_bind_) return {*buffer_, {}, 0};
    const vk::DeviceAddress place = address();
    if (place % kAddressAlignment != 0)
        throw MachineError(fmt::format("error: Vulkan: the address that {} gives to {} is not a multiple of {} bytes",
                                       context_->name, name_, kAddressAlignment));
    return {*buffer_, {}, place};
}

void VulkanBuffer::check_range(size_t bytes, size_t offset) const {
    if (offset > size_ || bytes > size_ - offset) {
        throw std::logic_error(
            fmt::format("buffer {} of {} bytes: {} bytes at {} are outside", name_, size_, bytes, offset));
    }
}

void VulkanBuffer::upload(const void* data, size_t bytes, size_t offset) {
    check_range(bytes, offset);
    if (bytes == 0) return;
    if (mapped_) {
        std::memcpy(static_cast<char*>(mapped_) + offset, data, bytes);
        return;
    }
    if (bytes <= kUpdateBytes && bytes % 4 == 0 && offset % 4 == 0) {
        context_->submit([&](vk::raii::CommandBuffer& commands) {
            commands.updateBuffer<uint8_t>(*buffer_, offset, {uint32_t(bytes), static_cast<const uint8_t*>(data)});
        });
        return;
    }
    const Staging& staging = context_->staging(Context::Direction::upload, std::min(bytes, kStagingBytes));
    for (size_t done = 0; done < bytes; done += kStagingBytes) {
        const size_t piece = std::min(kStagingBytes, bytes - done);
        std::memcpy(staging.mapped, static_cast<const char*>(data) + done, piece);
        context_->submit([&](vk::raii::CommandBuffer& commands) {
            commands.copyBuffer(*staging.buffer, *buffer_, vk::BufferCopy(0, offset + done, piece));
        });
    }
}

void VulkanBuffer::download(void* data, size_t bytes, size_t offset) const {
    check_range(bytes, offset);
    if (bytes == 0) return;
    if (mapped_) {
        std::memcpy(data, static_cast<const char*>(mapped_) + offset, bytes);
        return;
    }
    const Staging& staging = context_->staging(Context::Direction::download, std::min(bytes, kStagingBytes));
    for (size_t done = 0; done < bytes; done += kStagingBytes) {
        const size_t piece = std::min(kStagingBytes, bytes - done);
        context_->submit([&](vk::raii::CommandBuffer& commands) {
            commands.copyBuffer(*buffer_, *staging.buffer, vk::BufferCopy(offset + done, 0, piece));
            const vk::MemoryBarrier barrier(vk::AccessFlagBits::eTransferWrite, vk::AccessFlagBits::eHostRead);
            commands.pipelineBarrier(vk::PipelineStageFlagBits::eTransfer, vk::PipelineStageFlagBits::eHost, {},
                                     barrier, {}, {});
        });
        std::memcpy(static_cast<char*>(data) + done, staging.mapped, piece);
    }
}

void VulkanBuffer::fill_zero() {
    if (mapped_) {
        std::memset(mapped_, 0, size_);
        return;
    }
    context_->submit([&](vk::raii::CommandBuffer& commands) { commands.fillBuffer(*buffer_, 0, VK_WHOLE_SIZE, 0); });
}

}  // namespace lampyris::vulkan

// The CPU backend: kernels as C++, oneTBB over indices, Embree (or the shaders' BVH2, built as C++) for rays.
#include "backends/cpu/cpu_scene.h"
#include "backends/cpu/vectors.h"
#include "core/base/error.h"
#include "core/base/watch.h"
#include "core/device/device.h"
#include "core/device/device_choice.h"
#include "core/device/kernel_registry.h"

#include <embree3/rtcore_config.h>
#include <fmt/format.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <fstream>
#include <new>
#include <optional>
#include <span>
#include <thread>

namespace lampyris {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Treats denormals as zero, as some GPUs do. The mode is restored afterwards, because the thread may be the caller's.
class FlushDenormals {
 public:
    FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }
    ~FlushDenormals() { _mm_setcsr(saved_); }

 private:
    unsigned saved_;
};

struct MemoryMeter {
    size_t now = 0, peak = 0, limit = 0;
    void add(size_t bytes, std::string_view what) {
        if (limit && now + bytes > limit)
            throw MachineError(fmt::format(
                "error: {} needs {:.1f} MB, which goes beyond --max-memory ({:.1f} MB; {:.1f} MB are in use)", what,
                double(bytes) / 1e6, double(limit) / 1e6, double(now) / 1e6));
        now += bytes;
        peak = std::max(peak, now);
    }
};

class CpuBuffer final : public Buffer {
 public:
    CpuBuffer(size_t bytes, std::string_view name, std::shared_ptr<MemoryMeter> meter)
        : size_(bytes), meter_(std::move(meter)) {
        meter_->add(bytes, name);
        // 64 bytes more: readers may load whole vectors past the end.
        data_ = static_cast<std::byte*>(::operator new(bytes + 64, std::align_val_t(64), std::nothrow));
        if (!data_) {
            meter_->now -= bytes;
            throw MachineError(fmt::format("error: no memory for {} ({:.1f} MB)", name, double(bytes) / 1e6));
        }
        std::memset(data_, 0, bytes + 64);
    }
    ~CpuBuffer() override {
        meter_->now -= size_;
        ::operator delete(data_, std::align_val_t(64));
    }
    size_t size() const override { return size_; }
    // Of no bytes, there may be no data: memcpy must not be handed a null pointer.
    void upload(const void* data, size_t bytes, size_t offset) override {
        if (bytes > 0) std::memcpy(data_ + offset, data, bytes);
    }
    void download(void* data, size_t bytes, size_t offset) const override {
        if (bytes > 0) std::memcpy(data, data_ + offset, bytes);
    }
    void fill_zero() override { std::memset(data_, 0, size_); }
    void* data() { return data_; }

 private:
    size_t size_;
    std::shared_ptr<MemoryMeter> meter_;
    std::byte* data_ = nullptr;
};

class CpuKernel final : public Kernel {
 public:
    CpuKernel(std::string_view file, CpuKernelFunction run) : Kernel(file), scalar(run) {}
    const VectorKernel* vectors() const { return lazy ? lazy->code() : compiled.get(); }

    CpuKernelFunction scalar;
    std::shared_ptr<const VectorKernel> compiled;  // in place of the scalar build, from the start
    std::unique_ptr<LazyVectors> lazy;             // or once it pays
};

std::string processor_name() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "unknown processor";
}

class CpuDevice final : public Device {
 public:
    CpuDevice(CpuTracerKind tracer, const DeviceOptions& options)
        : tracer_(tracer), meter_(std::make_shared<MemoryMeter>()) {
        if (tracer == CpuTracerKind::embree) {
            check_settings(backend(), options, {"watertight", "vectors", "cache"});
            vectors_ = read_switch(options, "vectors", Switch::automatic);
            cache_ = read_cache_folder(options);
            watertight_ = read_switch(options, "watertight", Switch::on) != Switch::off;
        } else {
            check_settings(backend(), options, {});
        }
        meter_->limit = options.max_memory;
        const std::string name = description();
        choose_device(std::span(&name, 1), options.device, std::string("the backend ") + backend());
        threads_ = options.threads ? options.threads : std::max(1u, std::thread::hardware_concurrency());
        // TBB starts no more threads than the machine has, whatever size an arena has, unless this limit is raised.
        if (threads_ > std::thread::hardware_concurrency())
            more_threads_.emplace(oneapi::tbb::global_control::max_allowed_parallelism, threads_);
        arena_.initialize(int(threads_));
    }
    std::string backend() const override { return tracer_ == CpuTracerKind::embree ? "cpu" : "cpu-bvh2"; }
    std::string description() const override { return processor_name(); }
    unsigned threads() const override { return threads_; }
    bool offers(DeviceFeature feature) const override {
        return feature == DeviceFeature::kInt64Atomics || feature == DeviceFeature::kLongLoops;
    }

    BufferHandle create_buffer(size_t bytes, std::string_view name) override {
        return std::make_shared<CpuBuffer>(bytes, name, meter_);
    }

    DeviceSceneHandle upload(const Scene& scene) override {
        const auto start = Clock::now();
        std::shared_ptr<CpuScene> result;
        arena_.execute([&] { result = std::make_shared<CpuScene>(scene, tracer_, watertight_); });
        statistics_.build_s += seconds_since(start);
        meter_->add(result->memory_bytes(), "the scene's acceleration structure");
        return result;
    }

    KernelHandle compile(std::string_view file, uint64_t effects) override {
        auto kernel = std::make_shared<CpuKernel>(file, find_cpu_kernel(file, effects));
        if (vectors_ == Switch::automatic)
            kernel->lazy = std::make_unique<LazyVectors>(VectorRequest{std::string(file), effects, cache_});
        if (vectors_ != Switch::on) return kernel;
        const auto start = Clock::now();
        try {
            kernel->compiled = compile_in_vectors({std::string(file), effects, cache_}).kernel;
        } catch (const NotTranslated& reason) {
            throw MachineError(fmt::format("error: kernel {} cannot run in vectors: {}", file, reason.what()));
        }
        statistics_.compile_s += seconds_since(start);
        return kernel;
    }

    void run(const Kernel& kernel, const DeviceScene* scene, std::span<const NamedBuffer> buffers, uint32_t begin,
             uint32_t count) override {
        const CpuKernel& cpu_kernel = static_cast<const CpuKernel&>(kernel);
        const std::vector<BufferHandle> bound = cpu_kernel.bind(buffers);
        if (count == 0) return;
        const auto start = Clock::now();
        std::vector<void*> pointers(bound.size());
        for (size_t i = 0; i < bound.size(); ++i)
            pointers[i] = bound[i] ? static_cast<CpuBuffer&>(*bound[i]).data() : nullptr;
        const CpuScene* cpu_scene = static_cast<const CpuScene*>(scene);
        uint32_t unfinished = 0;
        std::atomic<uint64_t> in_vectors{0};
        CpuInvocation call;
        std::array<void*, CpuScene::kBufferCount> scene_buffers{};
        if (cpu_scene) std::copy_n(cpu_scene->buffers(), scene_buffers.size(), scene_buffers.begin());
        if (path_log()) scene_buffers[kernel::BINDING_PATH_LOG] = static_cast<CpuBuffer&>(*path_log()).data();
        call.scene_buffers = scene_buffers.data();
        call.kernel_buffers = pointers.data();
        call.tracer = cpu_scene ? &cpu_scene->tracer() : nullptr;
        call.unfinished = &unfinished;
        // Small blocks, handed out as threads become free, because path lengths vary a lot.
        const uint32_t block = std::clamp<uint32_t>(count / (threads_ * 32u), 1u, 256u);
        if (cpu_scene) cpu_scene->take_unfinished();  // of a run that was cut short
        const Watch& watch = current_watch();         // of the calling thread; TBB's threads have none
        arena_.execute([&] {
            tbb::parallel_for(
                tbb::blocked_range<uint64_t>(begin, uint64_t(begin) + count, block),
                [&](const tbb::blocked_range<uint64_t>& range) {
                    watch.check_cancelled();
                    const FlushDenormals flush;
                    CpuInvocation part = call;
                    part.begin = uint32_t(range.begin());
                    part.end = uint32_t(range.end());
                    if (run_block(cpu_kernel, part)) in_vectors += part.end - part.begin;
                },
                tbb::simple_partitioner{});
        });
        statistics_.kernel_s[cpu_kernel.file()] += seconds_since(start);
        DeviceStatistics::Invocations& invocations = statistics_.invocations[cpu_kernel.file()];
        invocations.all += count, invocations.in_vectors += in_vectors;
        if (unfinished || (cpu_scene && cpu_scene->take_unfinished()))
            throw UnfinishedError(
                fmt::format("error: kernel {} could not finish a loop within its bound; the image would be wrong",
                            cpu_kernel.file()));
    }

    DeviceStatistics statistics() const override {
        DeviceStatistics result = statistics_;
        result.memory_bytes = meter_->now;
        result.peak_memory_bytes = meter_->peak;
        return result;
    }

 private:
    CpuTracerKind tracer_;
    bool watertight_ = true;
    Switch vectors_ = Switch::off;
    std::filesystem::path cache_;  // of machine code

    // Whether it ran in vectors.
    static bool run_block(const CpuKernel& kernel, const CpuInvocation& call) {
        if (const VectorKernel* vectors = kernel.vectors()) {
            vectors->run(call);
            return true;
        }
        const auto start = Clock::now();
        kernel.scalar(call);
        if (kernel.lazy) kernel.lazy->spent(std::chrono::nanoseconds(Clock::now() - start).count());
        return false;
    }
    std::shared_ptr<MemoryMeter> meter_;
    unsigned threads_ = 1;
    std::optional<oneapi::tbb::global_control> more_threads_;
    tbb::task_arena arena_;
    DeviceStatistics statistics_;
};

DeviceInfo processor(const char* backend, const char* driver) {
    DeviceInfo info;
    info.backend = backend;
    info.name = processor_name();
    info.driver = driver;
    info.features["threads"] = std::to_string(std::thread::hardware_concurrency());
    return info;
}

const BackendRegistration cpu(
    "cpu", "C++ kernels on all processors, rays traced by Embree",
    [](const DeviceOptions& options) { return std::make_unique<CpuDevice>(CpuTracerKind::embree, options); },
    [] { return std::vector<DeviceInfo>{processor("cpu", "Embree " RTC_VERSION_STRING)}; });

const BackendRegistration cpu_bvh2(
    "cpu-bvh2", "the shaders' ray tracer as C++, for debugging and tests",
    [](const DeviceOptions& options) { return std::make_unique<CpuDevice>(CpuTracerKind::bvh2, options); },
    [] { return std::vector<DeviceInfo>{processor("cpu-bvh2", "BVH2")}; });

}  // namespace
}  // namespace lampyris

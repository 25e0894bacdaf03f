// Kernels in vectors: eight invocations at once, compiled by LLVM for exactly a scene's effects. They give the scalar builds' results to
// the bit, so that they may take over at any time. docs/decisions/vectors.md
#pragma once

#include "core/device/kernel_registry.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>

namespace lampyris {

class VectorKernel {
 public:
    virtual ~VectorKernel() = default;
    virtual void run(const CpuInvocation& call) const = 0;
};

// Why a kernel cannot run in vectors: it does what the translator does not know, or the processor has no AVX2.
struct NotTranslated : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// What the library liblampyris_vectors, which has LLVM, exports.
struct VectorCompiler {
    // Machine code is kept in the folder, unless its path is empty. With `only_kept`: null if there is none yet.
    // Throws NotTranslated.
    std::shared_ptr<const VectorKernel> (*compile)(const std::string& file, uint64_t effects,
                                                   const std::filesystem::path& folder, bool only_kept);
};

// Once compiled, a kernel is there for the whole process. Throws NotTranslated, also where the library cannot be loaded.
std::shared_ptr<const VectorKernel> compile_in_vectors(const std::string& file, uint64_t effects,
                                                       const std::filesystem::path& folder, bool only_kept);

// The vectors of one kernel, which are fetched in the background once it has run for long enough to be worth it.
class LazyVectors {
 public:
    LazyVectors(std::string file, uint64_t effects, std::filesystem::path folder);
    // Null until there is code.
    const VectorKernel* code() const { return job_->code.load(std::memory_order_acquire); }
    // The scalar build has run for so many nanoseconds more. Any thread may call it.
    void spent(int64_t nanoseconds);

 private:
    enum class State { counting, looking, absent, over };
    struct Job {
        std::string file;
        uint64_t effects;
        std::filesystem::path folder;
        std::atomic<State> state{State::counting};
        std::atomic<const VectorKernel*> code{nullptr};
    };
    static void fetch(const std::weak_ptr<Job>& job, bool only_kept);
    std::shared_ptr<Job> job_;
    std::atomic<int64_t> spent_{0};
};

}  // namespace lampyris

extern "C" const lampyris::VectorCompiler* lampyris_vectors();

// Kernels in vectors: eight invocations at once, compiled by LLVM for exactly a scene's effects. They give the scalar builds' results to
// the bit, so that they may take over at any time. docs/decisions/vectors.md
#pragma once

#include "core/device/kernel_registry.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <limits>
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

// What is to be compiled. Machine code is kept in the folder, unless its path is empty.
struct VectorRequest {
    std::string file;
    uint64_t effects = 0;
    std::filesystem::path folder;
    double most_s = std::numeric_limits<double>::infinity();  // CPU seconds that it may take, as expected
};

struct VectorResult {
    std::shared_ptr<const VectorKernel> kernel;  // null: it would take longer
    double expected_s = 0;                       // than asked for: so long; 0 if that is not known yet
};

// What the library liblampyris_vectors, which has LLVM, exports. Throws NotTranslated.
struct VectorCompiler {
    VectorResult (*compile)(const VectorRequest& request);
};

// Once compiled, a kernel is there for the whole process. Throws NotTranslated, also where the library cannot be loaded.
VectorResult compile_in_vectors(const VectorRequest& request);

// The vectors of one kernel, which are fetched in the background once it has run for long enough to be worth it.
class LazyVectors {
 public:
    explicit LazyVectors(VectorRequest request);
    // Null until there is code.
    const VectorKernel* code() const { return job_->code.load(std::memory_order_acquire); }
    // The scalar build has run for so many nanoseconds more. Any thread may call it.
    void spent(int64_t nanoseconds);

 private:
    struct Job {
        VectorRequest request;
        std::atomic<int64_t> next;  // how long the scalar build has to have run before the compiler is asked, in ns
        std::atomic<const VectorKernel*> code{nullptr};
    };
    static void fetch(const std::weak_ptr<Job>& job, double spent_s);
    std::shared_ptr<Job> job_;
    std::atomic<int64_t> spent_{0};
};

}  // namespace lampyris

extern "C" const lampyris::VectorCompiler* lampyris_vectors();

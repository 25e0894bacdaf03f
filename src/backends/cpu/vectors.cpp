#include "backends/cpu/vectors.h"

#include "core/base/background.h"
#include "core/base/library_beside.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <map>
#include <utility>

namespace lampyris {
namespace {

// CPU time of the scalar build, in ns, after which it is worth to load LLVM and to look for code that was kept (.02 s), and to find out how
// much there is to compile (.5 s).
constexpr int64_t kWorthLooking = 200'000'000, kWorthSizing = 2'500'000'000;

// A rendering is expected to go on for as long as it has taken so far, and vectors save a quarter of that: compiling pays after four
// times what it takes, or after half of that, as the code is kept for other renderings.
constexpr double kTimesWorth = 2;

constexpr int64_t kNever = std::numeric_limits<int64_t>::max();

const VectorCompiler& compiler() {
    static const VectorCompiler* const found = [] {
        std::string why;
        void* function = function_of_library_beside("liblampyris_vectors.so", "lampyris_vectors", why);
        if (!function) throw NotTranslated(fmt::format("the library liblampyris_vectors.so cannot be loaded: {}", why));
        return reinterpret_cast<const VectorCompiler* (*)()>(function)();
    }();
    return *found;
}

}  // namespace

VectorResult compile_in_vectors(const VectorRequest& request) {
    // Neither is ever destroyed: LLVM, which has the code, may be unloaded before.
    static std::mutex& mutex = *new std::mutex;
    static auto& known = *new std::map<std::pair<std::string, uint64_t>, std::shared_ptr<const VectorKernel>>;
    const std::lock_guard lock(mutex);
    std::shared_ptr<const VectorKernel>& kernel = known[{request.file, request.effects}];
    if (kernel) return {kernel};
    VectorResult result = compiler().compile(request);
    kernel = result.kernel;
    return result;
}

LazyVectors::LazyVectors(VectorRequest request) : job_(std::make_shared<Job>()) {
    job_->request = std::move(request);
    job_->next = kWorthLooking;
    wait_for_background_at_exit();
}

void LazyVectors::spent(int64_t nanoseconds) {
    const int64_t all = spent_.fetch_add(nanoseconds, std::memory_order_relaxed) + nanoseconds;
    int64_t next = job_->next.load(std::memory_order_relaxed);
    if (all < next || !job_->next.compare_exchange_strong(next, kNever)) return;
    const double spent_s = next == kWorthLooking ? 0 : double(all) * 1e-9;
    run_in_background([job = std::weak_ptr(job_), spent_s] { fetch(job, spent_s); });
}

void LazyVectors::fetch(const std::weak_ptr<Job>& wanted, double spent_s) {
    const std::shared_ptr<Job> job = wanted.lock();
    if (!job) return;  // the kernel is used no more
    try {
        job->request.most_s = spent_s / kTimesWorth;
        const VectorResult result = compile_in_vectors(job->request);
        job->code.store(result.kernel.get(), std::memory_order_release);
        if (result.kernel) return;
        const bool known = result.expected_s > 0;
        job->next.store(known ? std::max(int64_t(result.expected_s * kTimesWorth * 1e9), kWorthLooking + 1)
                              : kWorthSizing);
    } catch (const std::exception&) {  // the scalar build goes on
    }
}

}  // namespace lampyris

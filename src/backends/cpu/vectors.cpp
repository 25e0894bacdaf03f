#include "backends/cpu/vectors.h"

#include "core/base/background.h"
#include "core/base/library_beside.h"

#include <fmt/format.h>

#include <exception>
#include <map>
#include <utility>

namespace lampyris {
namespace {

// CPU time of the scalar build, in ns, after which it is worth to load LLVM (.02 s) and look for code that was kept, and after which it
// is worth to compile (.5 to 5 s): a rendering is expected to go on for as long as it has taken so far, and vectors save a quarter
// of that, in this run and in others.
constexpr int64_t kWorthLooking = 200'000'000, kWorthCompiling = 5'000'000'000;

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

std::shared_ptr<const VectorKernel> compile_in_vectors(const std::string& file, uint64_t effects,
                                                       const std::filesystem::path& folder, bool only_kept) {
    // Neither is ever destroyed: LLVM, which has the code, may be unloaded before.
    static std::mutex& mutex = *new std::mutex;
    static auto& known = *new std::map<std::pair<std::string, uint64_t>, std::shared_ptr<const VectorKernel>>;
    const std::lock_guard lock(mutex);
    std::shared_ptr<const VectorKernel>& kernel = known[{file, effects}];
    if (!kernel) kernel = compiler().compile(file, effects, folder, only_kept);
    return kernel;
}

LazyVectors::LazyVectors(std::string file, uint64_t effects, std::filesystem::path folder)
    : job_(std::make_shared<Job>(std::move(file), effects, std::move(folder))) {
    wait_for_background_at_exit();
}

void LazyVectors::spent(int64_t nanoseconds) {
    const int64_t all = spent_.fetch_add(nanoseconds, std::memory_order_relaxed) + nanoseconds;
    State state = job_->state.load(std::memory_order_relaxed);
    const bool only_kept = state == State::counting;
    if (only_kept ? all < kWorthLooking : state != State::absent || all < kWorthCompiling) return;
    if (!job_->state.compare_exchange_strong(state, State::looking)) return;
    run_in_background([job = std::weak_ptr(job_), only_kept] { fetch(job, only_kept); });
}

void LazyVectors::fetch(const std::weak_ptr<Job>& wanted, bool only_kept) {
    const std::shared_ptr<Job> job = wanted.lock();
    if (!job) return;  // the kernel is used no more
    State state = State::over;
    try {
        const auto kernel = compile_in_vectors(job->file, job->effects, job->folder, only_kept);
        job->code.store(kernel.get(), std::memory_order_release);
        if (!kernel) state = State::absent;
    } catch (const std::exception&) {  // the scalar build goes on
    }
    job->state.store(state);
}

}  // namespace lampyris

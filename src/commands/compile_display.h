// Says which kernel a driver is compiling, and for how long: on lavapipe there may be no other output for a minute.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace lampyris {

// Compilations of less than two seconds are not mentioned.
class CompileDisplay {
 public:
    explicit CompileDisplay(bool quiet);
    ~CompileDisplay();
    CompileDisplay(const CompileDisplay&) = delete;
    CompileDisplay& operator=(const CompileDisplay&) = delete;

    void heard(std::string_view kernel, bool begins);  // as Watch::compiling

 private:
    using Clock = std::chrono::steady_clock;
    void watch();

    const bool quiet_, terminal_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::string kernel_;  // empty: no kernel is being compiled
    Clock::time_point start_{};
    bool mentioned_ = false, ends_ = false;
    std::thread thread_;
};

}  // namespace lampyris

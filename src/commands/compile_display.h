// Says which kernel a driver compiles, and for how long: on lavapipe that may be a minute in which nothing else is heard.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace lampyris {

// What takes less than two seconds is not mentioned.
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
    std::string kernel_;  // empty: none is compiled
    Clock::time_point start_{};
    bool mentioned_ = false, ends_ = false;
    std::thread thread_;
};

}  // namespace lampyris

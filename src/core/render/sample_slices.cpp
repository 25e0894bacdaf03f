#include "core/render/sample_slices.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

namespace lampyris {

SampleSlices::SampleSlices(Device& device, Film& film)
    : film_(film), may_fail_(!device.offers(DeviceFeature::kLongLoops)) {}

void SampleSlices::run(uint32_t first, uint32_t count,
                       const std::function<void(uint32_t first, uint32_t count)>& work) {
    using Clock = std::chrono::steady_clock;
    Buffer& film = *film_.buffer();
    for (uint32_t done = 0; done < count;) {
        const uint32_t part = std::min({count - done, next_, most_});
        const bool can_repeat = may_fail_ && part > 1;
        if (can_repeat) {
            kept_.resize(film_.pixel_count());
            film.download(kept_.data(), kept_.size() * sizeof(kernel::FilmPixel));
        }
        const auto start = Clock::now();
        try {
            work(first + done, part);
        } catch (const UnfinishedError&) {
            if (!can_repeat) throw;
            film.upload(kept_.data(), kept_.size() * sizeof(kernel::FilmPixel));
            most_ = part / 2;
            spdlog::debug("the device ended the loops of a slice of {} samples: {} at most from here on", part, most_);
            continue;
        }
        done += part;
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (seconds > 2.0 * kSliceSeconds) next_ = std::max(1u, part / 2);
        if (seconds < kSliceSeconds && part == next_) next_ = part > most_ / 2 ? most_ : 2 * part;
    }
}

}  // namespace lampyris

// Splits samples of pixels into slices of a duration that the device can handle.
#pragma once

#include "core/render/film.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace lampyris {

class SampleSlices {
 public:
    SampleSlices(Device& device, Film& film);

    // Calls `work(first, count)` for the parts of [first, first + count), which add their samples to the film. A part is at
    // most twice as long as the one before, and takes about kSliceSeconds, so that few pixels with many samples trip no
    // watchdog. If the device ends long loops, the film is saved before each part of more than one sample. If such a part
    // throws UnfinishedError, the film is restored and the part is repeated in halves. With a single sample, the exception is
    // passed on.
    void run(uint32_t first, uint32_t count, const std::function<void(uint32_t first, uint32_t count)>& work);

    // Short enough to keep Ctrl-C and the progress line responsive, long enough that downloading the film takes far less than a
    // per cent.
    static constexpr double kSliceSeconds = 0.4;

 private:
    Film& film_;
    const bool may_fail_;
    uint32_t next_ = 1;  // samples of the next part
    uint32_t most_ = std::numeric_limits<uint32_t>::max();
    std::vector<kernel::FilmPixel> kept_;
};

}  // namespace lampyris

// Samples of pixels in slices as long as the device can do at once.
#pragma once

#include "core/film.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace lampyris {

class SampleSlices {
 public:
    SampleSlices(Device& device, Film& film);

    // Calls `work(first, count)` for the parts of [first, first + count), which add their samples to the film. A part is twice as
    // long as the one before at most, and about kSliceSeconds long, so that few pixels with many samples trip no watchdog. Where
    // the device ends long loops, the film is kept before each part of more than one sample: a part that comes to
    // UnfinishedError is halved and done again from the film as it was. That of a single sample is passed on.
    void run(uint32_t first, uint32_t count, const std::function<void(uint32_t first, uint32_t count)>& work);

    // Keeps Ctrl-C and the progress line responsive, and the film's download far below a per cent.
    static constexpr double kSliceSeconds = 0.4;

 private:
    Film& film_;
    const bool may_fail_;
    uint32_t next_ = 1;  // samples of the next part
    uint32_t most_ = std::numeric_limits<uint32_t>::max();
    std::vector<kernel::FilmPixel> kept_;
};

}  // namespace lampyris

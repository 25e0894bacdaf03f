// Like ppm_noise_test, for coats on backends whose compiler takes long for them.
#include "support/pass_noise.h"

#include <gtest/gtest.h>

namespace lampyris::test {
namespace {

TEST(PpmNoiseOfCoatsLong, AveragesOutOnEveryBackend) {
    for (const std::string& backend : usable_backends()) {
        SCOPED_TRACE(backend);
        expect_new_noise_on_a_coat(backend);
    }
}

}  // namespace
}  // namespace lampyris::test

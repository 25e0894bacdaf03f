// Few pixels with many samples: a slice that a driver's loop limit ends is repeated in halves, and no sample is lost or counted
// twice. Slices do not change a bit, so the correct image is that of a device without a limit.
#include "core/base/error.h"
#include "support/limited_device.h"
#include "support/runs.h"

#include <gtest/gtest.h>

#include <cstring>

namespace lampyris {
namespace {

const char* const kScene = R"(
Film "rgb" "integer xresolution" 6 "integer yresolution" 5
LookAt 0 1 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 50
WorldBegin
LightSource "infinite" "rgb L" [ 0.5 0.6 0.7 ]
Material "diffuse" "rgb reflectance" [ 0.6 0.5 0.4 ]
Shape "trianglemesh" "point3 P" [ -3 0 -3  3 0 -3  3 0 3  -3 0 3 ] "integer indices" [ 0 2 1 0 3 2 ]
Shape "trianglemesh" "point3 P" [ -1 0 1  1 0 1  0 1.5 1 ] "integer indices" [ 0 1 2 ]
)";

// A pixel that sees only a sky of radiance 1.
const char* const kSky = R"(
Film "rgb" "integer xresolution" 1 "integer yresolution" 1
Camera "perspective"
WorldBegin
LightSource "infinite"
)";

struct Case {
    std::string backend, integrator;
    uint32_t passes, eye_samples, most;
};

class SampleSlices : public testing::TestWithParam<Case> {
 protected:
    static test::RenderSettings settings() {
        test::RenderSettings s;
        s.backend = GetParam().backend;
        s.integrator = GetParam().integrator;
        s.samples = GetParam().passes;
        s.eye_samples = GetParam().eye_samples;
        return s;
    }
    static test::RenderSettings limited(uint32_t most, uint32_t& failures) {
        test::RenderSettings s = settings();
        s.wrap = [most, &failures](std::shared_ptr<Device> device) -> std::shared_ptr<Device> {
            return std::make_shared<test::LimitedDevice>(std::move(device), most, failures);
        };
        return s;
    }
};

TEST_P(SampleSlices, AFailedSliceIsHalvedAndLosesNothing) {
    const test::Rendered expected = test::render_text(kScene, settings());
    uint32_t failures = 0;
    const test::Rendered found = test::render_text(kScene, limited(GetParam().most, failures));
    EXPECT_GT(failures, 0u) << "no slice was long enough to fail";
    ASSERT_EQ(found.pixels.size(), expected.pixels.size());
    for (size_t i = 0; i < found.pixels.size(); ++i)
        ASSERT_EQ(std::memcmp(&found.pixels[i], &expected.pixels[i], sizeof found.pixels[i]), 0) << "pixel " << i;
    EXPECT_EQ(found.summary.samples, expected.summary.samples);
}

TEST_P(SampleSlices, ASampleThatFailsAloneIsAnError) {
    uint32_t failures = 0;
    EXPECT_THROW(test::render_text(kScene, limited(0, failures)), UnfinishedError);
    EXPECT_EQ(failures, 1u) << "a single sample cannot be halved";
}

std::vector<Case> cases() {
    std::vector<Case> all;
    for (const std::string& backend : test::usable_backends()) {
        all.push_back({backend, "path:maxdepth=3", 100, 1, 3});
        all.push_back({backend, "ao:rays=4", 100, 1, 5});
        all.push_back({backend, "ppm:photonsperiteration=100,radius=0.2", 2, 40, 7});
    }
    return all;
}
INSTANTIATE_TEST_SUITE_P(All, SampleSlices, testing::ValuesIn(cases()), [](const auto& info) {
    return test::name_of(info.param.backend + "_" + info.param.integrator.substr(0, info.param.integrator.find(':')));
});

// On a driver that ends loops (Mesa before 25) there are real failures; on others the test holds, too.
TEST(SampleSlicesOfDrivers, OnePixelTakesAnyNumberOfSamples) {
    for (const std::string& backend : test::usable_backends()) {
        SCOPED_TRACE(backend);
        test::RenderSettings s;
        s.backend = backend;
        s.integrator = "path";
        s.samples = 200'000;
        const test::Rendered image = test::render_text(kSky, s);
        EXPECT_EQ(image.summary.samples, 200'000u);
        // The sums of the film are compensated: the remaining error is the rounding of one division.
        EXPECT_NEAR(image.value(0, 0, 0), 1.0f, 1e-6f);
    }
}

// The loops of eye_pass and hit_resolve run once per hit point.
TEST(SampleSlicesOfDrivers, OnePixelHasAnyNumberOfHitPoints) {
    for (const std::string& backend : test::usable_backends()) {
        SCOPED_TRACE(backend);
        test::RenderSettings s;
        s.backend = backend;
        s.integrator = "ppm:photonsperiteration=10";
        s.samples = 1;
        s.eye_samples = 70'000;
        const test::Rendered image = test::render_text(kSky, s);
        EXPECT_EQ(image.summary.samples, 70'000u);
        EXPECT_NEAR(image.value(0, 0, 0), 1.0f, 1e-6f);
    }
}

}  // namespace
}  // namespace lampyris

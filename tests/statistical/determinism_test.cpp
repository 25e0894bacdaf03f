// An image is a function of scene, seed and settings: it does not depend on threads, on how passes are split into dispatches,
// or on the window that is rendered. Equal means equal to the bit, for every number in the film; no tolerance, no false alarms.
#include "support/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace lampyris::test {
namespace {

class DeterminismTest : public testing::TestWithParam<std::string> {
 protected:
    static Rendered render(const RenderSettings& settings) {
        return render_file(std::string(LAMPYRIS_SOURCE_DIR) + "/scenes/reference/thin-lens.pbrt", settings);
    }

    // Odd sizes, so that blocks of work are cut at the edges; a number of samples that is not a power of two.
    static RenderSettings settings() {
        RenderSettings s;
        s.backend = GetParam();
        s.resolution = {{37, 29}};
        s.samples = 11;
        s.seed = 4711;
        return s;
    }
    static void expect_same(const Rendered& a, const Rendered& b) {
        ASSERT_EQ(a.pixels.size(), b.pixels.size());
        for (size_t i = 0; i < a.pixels.size(); ++i)
            ASSERT_EQ(std::memcmp(&a.pixels[i], &b.pixels[i], sizeof(a.pixels[i])), 0) << "pixel " << i;
    }
};

TEST_P(DeterminismTest, ThreadsDoNotMatter) {
    if (GetParam() == "vulkan") GTEST_SKIP() << "threads are the driver's";
    RenderSettings s = settings();
    s.threads = 1;
    const Rendered one = render(s);
    for (const unsigned threads : {2u, 7u}) {
        s.threads = threads;
        expect_same(one, render(s));
    }
}

TEST_P(DeterminismTest, SlicesDoNotMatter) {
    RenderSettings s = settings();
    const Rendered as_the_session_decides = render(s);
    for (const uint32_t slice : {1u, 3u}) {
        s.slice = slice;
        expect_same(as_the_session_decides, render(s));
    }
}

TEST_P(DeterminismTest, RunsAreRepeatable) { expect_same(render(settings()), render(settings())); }

TEST_P(DeterminismTest, WindowsShowTheSamePixels) {
    const Rendered whole = render(settings());
    RenderSettings s = settings();
    s.crop = {{5, 3, 24, 20}};
    const Rendered part = render(s);
    ASSERT_EQ(part.width, 19);
    ASSERT_EQ(part.height, 17);
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x)
            ASSERT_EQ(std::memcmp(&part.pixels[size_t(y * part.width + x)],
                                  &whole.pixels[size_t((y + 3) * whole.width + x + 5)], sizeof(kernel::FilmPixel)),
                      0)
                << x << ", " << y;
}

// A single sample of one pixel, rendered alone, is the same as among the others; all of them add up to the pixel.
TEST_P(DeterminismTest, ReplayShowsThePixelsSamples) {
    RenderSettings s = settings();
    const Rendered whole = render(s);
    s.crop = {{12, 17, 13, 18}};
    s.samples = 1;
    double sum[3] = {};
    uint32_t rays = 0;
    for (uint32_t pass = 0; pass < 11; ++pass) {
        s.first_pass = pass;
        const Rendered one = render(s);
        ASSERT_EQ(one.pixels.size(), 1u);
        for (int c = 0; c < 3; ++c) sum[c] += one.pixels[0].sum[c];
        rays += one.pixels[0].rays;
    }
    const kernel::FilmPixel& pixel = whole.pixels[17 * 37 + 12];
    EXPECT_EQ(rays, pixel.rays);
    for (int c = 0; c < 3; ++c) {
        EXPECT_GT(pixel.sum[c], 0.0f);
        EXPECT_NEAR(sum[c], double(pixel.sum[c]) + double(pixel.low[c]), 1e-6 * sum[c]) << c;
    }
}

TEST_P(DeterminismTest, SeedsDiffer) {
    RenderSettings s = settings();
    const Rendered a = render(s);
    s.seed = 4712;
    const Rendered b = render(s);
    size_t different = 0, lit = 0;  // outside of the room, nothing can differ
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        different += a.pixels[i].sum != b.pixels[i].sum;
        lit += a.pixels[i].sum.x > 0.0f || b.pixels[i].sum.x > 0.0f;
    }
    EXPECT_GT(lit, a.pixels.size() / 2);
    EXPECT_GT(different, lit * 99 / 100);
}

INSTANTIATE_TEST_SUITE_P(Backends, DeterminismTest, testing::ValuesIn(usable_backends()), [](const auto& info) {
    std::string name = info.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

}  // namespace
}  // namespace lampyris::test

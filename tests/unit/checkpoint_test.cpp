// Checkpoints: a rendering that goes on from one gives the image of one that was never interrupted, to the bit.
#include "core/render/checkpoint.h"

#include "support/checkpoint.h"
#include "support/render_error.h"

#include <gtest/gtest.h>

#include <cctype>
#include <string>
#include <tuple>
#include <vector>

namespace lampyris {
namespace {

using test::checkpoint_request;
using test::error_of;
using test::expect_same_outcome;
using test::kRoom;
using test::Temporary;

bool keeps_most(const std::string& integrator) {
    return integrator.starts_with("path") || integrator.starts_with("ppm") ||
           (integrator.starts_with("sppm") && integrator.find("schedule") == std::string::npos);
}

// All on the CPU. Vulkan has the same host code, and its shaders take minutes to compile: there, those that keep most.
std::vector<std::tuple<std::string, std::string>> cases() {
    std::vector<std::tuple<std::string, std::string>> found;
    for (const std::string& backend : test::usable_backends())
        for (const std::string& integrator : test::kCheckpointIntegrators)
            if (backend != "vulkan" || keeps_most(integrator)) found.emplace_back(integrator, backend);
    return found;
}

class CheckpointTest : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(CheckpointTest, GoesOnAsIfNeverInterrupted) {
    test::expect_to_go_on(std::get<0>(GetParam()), std::get<1>(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Integrators, CheckpointTest, testing::ValuesIn(cases()), [](const auto& info) {
    std::string name = std::get<0>(info.param) + "_" + std::get<1>(info.param);
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
});

TEST(Checkpoint, OfAnotherRenderingIsRefused) {
    const Temporary file;
    RenderRequest request = checkpoint_request("path:maxdepth=6", 2);
    request.checkpoint = file.name();
    render(request);
    request.resume = true;
    EXPECT_EQ(error_of(request), "no error");
    const auto with = [&](auto change) {
        RenderRequest other = checkpoint_request("path:maxdepth=6", 4);
        other.checkpoint = file.name();
        other.resume = true;
        change(other);
        return error_of(other);
    };
    EXPECT_NE(with([](RenderRequest& r) { r.seed = 5; }).find("its seed is 0, here it is 5"), std::string::npos)
        << with([](RenderRequest& r) { r.seed = 5; });
    EXPECT_NE(with([](RenderRequest& r) {
                  r.integrator = "path:maxdepth=7";
              }).find("its integrator.maxdepth is 6, here it is 7"),
              std::string::npos);
    EXPECT_NE(with([](RenderRequest& r) { r.integrator = "ao"; }).find("its integrator is path, here it is ao"),
              std::string::npos);
    EXPECT_NE(with([](RenderRequest& r) { r.backend = "cpu-bvh2"; }).find("its backend is cpu"), std::string::npos);
    EXPECT_NE(with([](RenderRequest& r) { r.build.crop = {{1, 1, 3, 3}}; }).find("its crop is"), std::string::npos);
    EXPECT_NE(with([](RenderRequest& r) {
                  r.scene = SceneSource::of_text(kRoom + "Shape \"sphere\"\n", "room.pbrt");
              }).find("its scene is"),
              std::string::npos);
}

TEST(Checkpoint, IsNotOverwrittenByAnotherRendering) {
    const Temporary file;
    file.write("something of value");
    RenderRequest request = checkpoint_request("path", 1);
    request.checkpoint = file.name();
    EXPECT_NE(error_of(request).find("go on with it (--resume), or remove it"), std::string::npos);
    request.resume = true;
    EXPECT_NE(error_of(request).find("is no checkpoint that can be resumed"), std::string::npos);
    EXPECT_EQ(file.content(), "something of value");
}

TEST(Checkpoint, NeedsAFile) {
    RenderRequest request = checkpoint_request("path", 1);
    request.resume = true;
    EXPECT_NE(error_of(request).find("name it with --checkpoint"), std::string::npos);
    request.checkpoint = "/dev/null";
    EXPECT_NE(error_of(request).find("no regular file"), std::string::npos);
    request.checkpoint = "/no such folder/a";
    EXPECT_NE(error_of(request), "no error");
}

TEST(Checkpoint, DamageIsFound) {
    const Temporary file;
    RenderRequest request = checkpoint_request("sppm:radius=0.2,photonsperiteration=500", 2);
    request.checkpoint = file.name();
    render(request);
    const std::string right = file.content();
    ASSERT_GT(right.size(), 2000u);
    EXPECT_TRUE(read_checkpoint(file.name()));
    const auto is_refused = [&](const std::string& content) {
        file.write(content);
        try {
            read_checkpoint(file.name());
        } catch (const InputError&) {
            return true;
        }
        return false;
    };
    for (size_t i = 0; i < right.size(); i += 1 + right.size() / 300) {
        std::string wrong = right;
        wrong[i] = char(wrong[i] ^ 4);
        EXPECT_TRUE(is_refused(wrong)) << "byte " << i;
        EXPECT_TRUE(is_refused(right.substr(0, i))) << i << " bytes";
    }
    EXPECT_TRUE(is_refused(right + "x"));
    file.write(right);
    EXPECT_TRUE(read_checkpoint(file.name()));
}

// The hash is right, but what it covers is not.
TEST(Checkpoint, NonsenseIsRefused) {
    const Temporary file;
    RenderRequest request = checkpoint_request("path:maxdepth=6", 2);
    request.checkpoint = file.name();
    render(request);
    const Checkpoint right = *read_checkpoint(file.name());
    const auto is_refused = [&](auto change) {
        Checkpoint wrong = right;
        change(wrong);
        write_checkpoint(file.name(), wrong);
        try {
            read_checkpoint(file.name());
        } catch (const InputError&) {
            return true;
        }
        return false;
    };
    EXPECT_FALSE(is_refused([](Checkpoint&) {}));
    EXPECT_TRUE(is_refused([](Checkpoint& c) { c.session.passes = uint64_t(1) << 62; }));
    EXPECT_TRUE(is_refused([](Checkpoint& c) { c.session.passes = 0; }));
    EXPECT_TRUE(is_refused([](Checkpoint& c) { c.session.wall_s = -1.0; }));
    EXPECT_TRUE(is_refused([](Checkpoint& c) { c.total_s = 1e300; }));
    EXPECT_TRUE(is_refused([](Checkpoint& c) { c.session.history.clear(); }));
    EXPECT_TRUE(is_refused([](Checkpoint& c) { c.session.history.push_back(c.session.history.front()); }));
}

// What the variance between passes cannot show is known again.
TEST(Checkpoint, AnUnstableEstimateStaysSo) {
    const Temporary file;
    RenderRequest request = checkpoint_request("mlt:maxdepth=6,chains=8,bootstrapsamples=1,mutationsperpixel=1", 20);
    request.checkpoint = file.name();
    const std::string unstable = render(request).record.progress.unstable;
    ASSERT_NE(unstable.find("brightness"), std::string::npos) << unstable;
    request.resume = true;
    EXPECT_EQ(render(request).record.progress.unstable, unstable);
}

// Interrupts the rendering at its first look, and counts the images that it is handed.
class Listener final : public RenderObserver {
 public:
    bool interrupts = false;
    int images = 0;
    std::vector<std::string> notes;
    void note(const std::string& text) override { notes.push_back(text); }
    void progress(const RenderProgress& progress, const Film&) override {
        if (interrupts && progress.passes >= 4) interrupt();
    }
    double wants_image_every() const override { return 1e-9; }
    void image_so_far(const RenderOutcome& outcome) override {
        ++images;
        EXPECT_EQ(outcome.image.width, 24);
        EXPECT_GT(outcome.record.progress.passes, 0u);
    }
};

TEST(Checkpoint, AnInterruptedRenderingLeavesOne) {
    const RenderOutcome whole = render(checkpoint_request("path:maxdepth=6", 64));
    const Temporary file;
    RenderRequest request = checkpoint_request("path:maxdepth=6", 64);
    request.checkpoint = file.name();
    request.resume = true;
    Listener listener;
    listener.interrupts = true;
    const RenderOutcome part = render(request, listener);
    EXPECT_EQ(part.record.ended, RenderEnd::kInterrupted);
    EXPECT_LT(part.record.progress.passes, 64u);
    ASSERT_EQ(listener.notes.size(), 1u) << "there was no checkpoint at first";
    EXPECT_GT(listener.images, 0);
    expect_same_outcome(render(request), whole);
    EXPECT_EQ(read_checkpoint(file.name())->session.passes, 64u);
}

}  // namespace
}  // namespace lampyris

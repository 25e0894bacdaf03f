// Renderings of a small room that are cut short, and go on from a checkpoint.
#pragma once

#include "core/base/file.h"
#include "core/render/render.h"
#include "support/render.h"
#include "support/replay.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace lampyris::test {

// A file that is gone at the end of the test.
class Temporary {
 public:
    Temporary() {
        static int count = 0;
        path_ =
            std::filesystem::temp_directory_path() / fmt::format("lampyris-checkpoint-test-{}-{}", ::getpid(), ++count);
    }
    ~Temporary() { std::filesystem::remove_all(path_); }
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;
    std::string name() const { return path_.string(); }
    std::string content() const {
        std::ifstream stream(path_, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    void write(const std::string& content) const { write_file_atomically(name(), content); }

 private:
    std::filesystem::path path_;
};

inline RenderRequest checkpoint_request(const std::string& integrator, uint64_t passes) {
    RenderRequest request;
    request.scene = SceneSource::of_text(kRoom, "room.pbrt");
    const size_t plus = integrator.find('+');
    request.integrator = integrator.substr(0, plus);
    if (plus != std::string::npos) request.photon_map = integrator.substr(plus + 1);
    if (request.integrator.starts_with("ppm")) request.samples_per_pixel = 2;
    request.limits.passes = passes;
    return request;
}

inline void expect_same_outcome(const RenderOutcome& a, const RenderOutcome& b) {
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    size_t different = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i)
        different += a.pixels[i].sum != b.pixels[i].sum || a.pixels[i].squares != b.pixels[i].squares ||
                     a.pixels[i].samples != b.pixels[i].samples || a.pixels[i].rays != b.pixels[i].rays;
    EXPECT_EQ(different, 0u);
    EXPECT_EQ(a.image.pixels, b.image.pixels);
    EXPECT_EQ(a.record.progress.passes, b.record.progress.passes);
    EXPECT_EQ(a.record.counts, b.record.counts);
    EXPECT_EQ(a.record.photons.emitted, b.record.photons.emitted);
    EXPECT_EQ(a.record.photons.rays, b.record.photons.rays);
}

inline const std::vector<std::string> kCheckpointIntegrators = {
    "path:maxdepth=6",
    "ao",
    "light:maxdepth=6,lightpaths=2000",
    "bdpt:maxdepth=6",
    "bdpt:maxdepth=6,cache=2,counts=auto",
    "vcm:maxdepth=6,radius=0.2,lightpaths=4000+stochastic_hash",
    "bpm:maxdepth=6,radius=0.2,lightpaths=4000+sorted_grid",
    "sppm:maxdepth=6,radius=0.2,photonsperiteration=4000",
    "sppm:maxdepth=6,radius=0.2,photonsperiteration=4000,store=500+stochastic_hash",
    "sppm:maxdepth=6,radius=0.2,photonsperiteration=4000,schedule=shared",
    "ppm:maxdepth=6,radius=0.2,photonsperiteration=4000",
    "photon_map:photons=4000,gather=4",
    "mlt:maxdepth=6,chains=64"};

// After one pass, after three, and when all are done.
inline void expect_to_go_on(const std::string& integrator, const std::string& backend) {
    const std::shared_ptr<Device> device = create_device(backend, {});
    const auto outcome_of = [&](uint64_t passes, const std::string& checkpoint, bool resume) {
        RenderRequest request = checkpoint_request(integrator, passes);
        request.device = device;
        request.checkpoint = checkpoint;
        request.resume = resume;
        return render(request);
    };
    const RenderOutcome whole = outcome_of(7, "", false);
    const Temporary file;
    outcome_of(1, file.name(), false);
    outcome_of(3, file.name(), true);
    expect_same_outcome(outcome_of(7, file.name(), true), whole);
    // There is nothing left to do, and the image is still there.
    expect_same_outcome(outcome_of(7, file.name(), true), whole);
}

}  // namespace lampyris::test

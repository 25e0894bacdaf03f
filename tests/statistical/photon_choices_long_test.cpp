// Like photon_choices_test, with textured masks and mixes on backends whose compiler takes long for them.
#include "support/choices_floor.h"

#include <gtest/gtest.h>

#include <string>

namespace lampyris::test {
namespace {

TEST(PhotonChoicesLong, AreMadeOnceByTextures) {
    for (const std::string& backend : usable_backends()) {
        SCOPED_TRACE(backend);
        expect_tiles(render_text(floor_scene(true),
                                 settings_of(backend,
                                             "sppm:maxdepth=1,direct=photons,radius=0.008,photonsperiteration=40000,"
                                             "schedule=memoryless,alpha=1",
                                             32, 0)),
                     0.02);
    }
}

}  // namespace
}  // namespace lampyris::test

// An integrator for tests: a first pass of black, and then what `HANGS` in the environment says.
#include "core/base/error.h"
#include "core/render/integrator.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <string>
#include <thread>
#include <vector>

namespace lampyris {
namespace {

struct HangsParams {};
#define HANGS_PARAMS(X)

class Hangs : public Integrator {
 public:
    HangsParams params;
    void render(RenderSession& session) override {
        session.passes_finished(session.next_passes());
        const char* asked = std::getenv("HANGS");
        const std::string what = asked ? asked : "";
        if (what == "device lost") throw MachineError("error: the device was lost");
        if (what == "no memory") throw std::bad_alloc();
        if (what.starts_with("remove ")) std::filesystem::remove_all(what.substr(7));
        std::vector<char> memory(what == "eats memory" ? size_t(600) << 20 : 0, 'x');
        if (what == "for ever") std::this_thread::sleep_for(std::chrono::hours(1));
        while (const uint32_t passes = session.next_passes()) session.passes_finished(passes);
    }
};

REGISTER_INTEGRATOR(Hangs, HANGS_PARAMS, "hangs", "Renders one pass of black, and then fails or hangs.")

}  // namespace
}  // namespace lampyris

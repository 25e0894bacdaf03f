// How a rendering reports its progress: one line that is redrawn on a terminal, plain lines elsewhere, nothing when quiet.
#pragma once

#include "core/render/render_session.h"

#include <string>

namespace lampyris {

class ProgressDisplay {
 public:
    ProgressDisplay(bool quiet, BudgetLimits limits);
    void show(const RenderProgress& progress);
    // "estimated relMSE 1.2e-03, halving takes 12.1 s to 18.0 s more (90 %)"
    static std::string error_text(const RenderProgress& progress);
    // Whether --target-error was reached, in a line; empty without it.
    static std::string target_text(const RenderProgress& progress);

 private:
    double share_done(const RenderProgress& progress) const;
    void note_unstable_target(const RenderProgress& progress);
    bool quiet_, terminal_;
    BudgetLimits limits_;
    double last_plain_s_ = -1e9;
    bool noted_ = false;
};

std::string duration_text(double seconds);  // "850 ms", "12.3 s", "4 min 10 s", "2 h 3 min"

}  // namespace lampyris

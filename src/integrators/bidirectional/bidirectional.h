// The passes of `bdpt`, `vcm` and `bpm`.
#pragma once

#include "core/render/render_session.h"
#include "integrators/bidirectional/bidirectional_host.h"

#include <cstdint>
#include <vector>

namespace lampyris {

struct BidirectionalOptions {
    const char* name = "";
    int maxdepth = 5;
    int rrdepth = 3;
    int lightpaths = -1;                    // in each pass; -1: as many as the picture has pixels
    bool light_paths = true;                // false: none, whatever `lightpaths` says, which is path tracing
    int connections = -1;                   // of a camera vertex with a light path; -1: all
    int cache = 0;                          // light paths to which it is connected at each depth; 0: one at all depths
    uint32_t weights = 0;                   // kernel::WEIGHTS_*
    int only_light = -1, only_camera = -1;  // strategy, as counts of vertices; -1: all
    uint32_t strategies = 0;                // kernel::STRATEGIES_*
    // Merging: the radius of the first pass in scene units, or 0 for `radius_share` of the scene's radius; negative: none.
    double radius = -1.0, radius_share = 0.0;
    double alpha = 0.75;  // of its decrease (Knaus and Zwicker 2011)
    // Receives for each pixel, summed over the passes, in the mean of the channels: what camera paths contribute alone (s = 0 and 1), by
    // connections, what splats do, and what merging does.
    std::vector<glm::vec4>* shares = nullptr;
};

// Throws InputError if parameters contradict each other.
void check_connections(const BidirectionalOptions& options);

// Of an integrator that connects vertices, with the parameters of SUBPATH_PARAMS, CONNECTION_PARAMS and `weights`. Throws InputError.
template <typename Params>
BidirectionalOptions connection_options(const char* name, const Params& params) {
    BidirectionalOptions options{.name = name,
                                 .maxdepth = params.maxdepth,
                                 .rrdepth = params.rrdepth,
                                 .lightpaths = params.lightpaths,
                                 .connections = params.connections,
                                 .cache = params.cache,
                                 .weights = params.weights};
    check_connections(options);
    return options;
}

// The number of light paths in each pass of a scene's picture.
uint32_t light_path_count(const BidirectionalOptions& options, const Scene& scene);

// Renders until the session's budget is spent. Throws InputError, MachineError.
void render_bidirectional(RenderSession& session, const BidirectionalOptions& options);

// The same without light paths: strategies s = 0 and 1 are path tracing, whose kernel takes less time for them.
void render_camera_paths(RenderSession& session, const BidirectionalOptions& options);

// Renders the session's passes again by each strategy alone, for paths with up to `depth` scattering vertices, and keeps the
// images as layers of the session: strategy.s1t3 as it is weighed, alone.s1t3 without weights.
void render_strategies(RenderSession& session, const BidirectionalOptions& options, int depth);

}  // namespace lampyris

#include "core/render/integrator.h"
#include "integrators/path/path_params.h"

REGISTER_RADIANCE(PathParams, PATH_PARAMS, "path", "integrators/path/path.radiance.h",
                  "Path tracing with next-event estimation and multiple importance sampling.")

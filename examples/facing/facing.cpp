#include "core/render/integrator.h"
#include "facing/facing_params.h"

REGISTER_RADIANCE(FacingParams, FACING_PARAMS_LIST, "facing", "facing/facing.radiance.h",
                  "Facing ratio: how squarely each surface faces the viewer.")

#include "core/render/integrator.h"
#include "integrators/ao/ao_params.h"

REGISTER_RADIANCE(AoParams, AO_PARAMS, "ao", "integrators/ao/ao.radiance.h",
                  "Ambient occlusion: the share of the sky that each point sees.")

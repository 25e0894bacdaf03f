// Film, PixelFilter, Sampler and Option directives: settings of the picture rather than of the world.
#pragma once

#include "core/scene/builder.h"

namespace lampyris {

struct FilmContext {
    BuildContext& build;
    ParameterReader& reader;
    kernel::CameraRecord& record;
};
using FilmFactory = void (*)(FilmContext&);
Registry<FilmFactory>& film_registry();
struct RegisterFilm {
    RegisterFilm(const char* name, const char* summary, ParameterSpecs specs, FilmFactory factory);
};

struct SamplerContext {
    BuildContext& build;
    ParameterReader& reader;
};
using SamplerFactory = void (*)(SamplerContext&);
Registry<SamplerFactory>& sampler_registry();
struct RegisterSampler {
    RegisterSampler(const char* name, const char* summary, ParameterSpecs specs, SamplerFactory factory);
};

// Builds camera, film, filter and sampler of the scene; fills in records and settings.
void build_view(BuildContext& context);

}  // namespace lampyris

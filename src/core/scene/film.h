// Film, PixelFilter, Sampler, Option: how the picture is taken, rather than of what.
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

// Camera, film, filter and sampler of the scene; records and settings are filled in.
void build_view(BuildContext& context);

}  // namespace lampyris

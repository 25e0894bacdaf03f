// pbrt-v4's samplers, mapped to the two that Lampyris has: independent random numbers, and Owen-scrambled Sobol points.
#include "core/scene/film.h"
#include "core/scene/limits.h"

#include <fmt/format.h>

namespace lampyris {

namespace {

void set_sampler(SamplerContext& context, const char* kind, int samples) {
    const std::string& name = context.reader.entity().type;
    SceneSettings& settings = context.build.settings;
    settings.sampler = kind;
    settings.samples_per_pixel = samples;
    settings.seed = uint32_t(context.reader.get_int("seed"));
    if (name != kind && context.reader.entity().given())
        context.build.scene.notes.push_back(fmt::format(
            "Sampler \"{}\" is mapped to {}", name,
            std::string_view(kind) == "sobol" ? "Owen-scrambled Sobol points" : "independent random numbers"));
}

void build_independent(SamplerContext& context) {
    set_sampler(context, "independent", context.reader.get_int("pixelsamples"));
}

void build_sobol(SamplerContext& context) {
    if (find_spec(context.reader.specs(), "randomization")) context.reader.get_string("randomization");
    set_sampler(context, "sobol", context.reader.get_int("pixelsamples"));
}

void build_stratified(SamplerContext& context) {
    context.reader.get_bool("jitter");
    const int64_t samples = int64_t(context.reader.get_int("xsamples")) * context.reader.get_int("ysamples");
    if (samples > kMostSamples)
        context.reader.error("xsamples", fmt::format("{} samples a pixel", samples),
                             fmt::format("at most {}", kMostSamples));
    set_sampler(context, "sobol", samples > kMostSamples ? 1 : int(samples));
}

ParameterSpec samples_spec() { return integer("pixelsamples", 16, "samples for each pixel").between(1, kMostSamples); }
ParameterSpec seed_spec() { return integer("seed", 0, "another seed gives other random numbers"); }
ParameterSpecs plain_specs() { return {samples_spec(), seed_spec()}; }
ParameterSpecs random_specs() {
    return {samples_spec(), seed_spec(),
            text("randomization", "fastowen", "pbrt's way to randomize; here points are always Owen-scrambled")
                .one_of({"none", "permutedigits", "fastowen", "owen"})};
}
ParameterSpecs stratified_specs() {
    return {integer("xsamples", 4, "strata across a pixel").between(1, 1 << 20),
            integer("ysamples", 4, "strata down a pixel").between(1, 1 << 20),
            boolean("jitter", true, "has no effect here"), seed_spec()};
}

const RegisterSampler independent("independent", "Independent random numbers.", plain_specs(), build_independent);
const RegisterSampler sobol("sobol", "Owen-scrambled Sobol points.", random_specs(), build_sobol);
const RegisterSampler zsobol("zsobol", "Mapped to sobol.", random_specs(), build_sobol);
const RegisterSampler paddedsobol("paddedsobol", "Mapped to sobol.", random_specs(), build_sobol);
const RegisterSampler halton("halton", "Mapped to sobol.", random_specs(), build_sobol);
const RegisterSampler pmj02bn("pmj02bn", "Mapped to sobol.", plain_specs(), build_sobol);
const RegisterSampler stratified("stratified", "Mapped to sobol, xsamples times ysamples of them.", stratified_specs(),
                                 build_stratified);

}  // namespace

}  // namespace lampyris

// Coats: a dielectric interface over a diffuse or metallic base, with an optional scattering medium in between,
// evaluated by a random walk through the layers (pbrt, 4th edition, section 14.3; Guo et al. 2018, "Position-Free Monte
// Carlo Simulation for Arbitrary Layered BSDFs"). Values are estimates up to max_depth, unbiased for smooth coats
// and with MATERIAL_EXACT_COAT. They are functions of the two directions: the bits of the directions are the keys of the
// random numbers. Densities are pbrt's approximations.
//
// Both sides have the coat (pbrt's twoSided): directions are flipped so that wo.z > 0. The coat's interface is at
// height `thickness`, the base at 0; the medium's extinction is 1. The base does not transmit.
#ifndef LAMPYRIS_MATERIALS_LAYERED
#define LAMPYRIS_MATERIALS_LAYERED

#include "materials/conductor/conductor_bsdf.h"
#include "materials/dielectric/dielectric_bsdf.h"
#include "materials/diffuse/diffuse_bsdf.h"

// ---- The base --------------------------------------------------------------------------------------------------------

FN bool base_is_specular(IN(Bsdf) b) { return b.kind == MATERIAL_COATEDCONDUCTOR && ggx_is_smooth(b.alpha_base); }

FN Spectrum base_eval(IN(Bsdf) b, vec3 wo, vec3 wi, OUT(float) pdf) {
    if (b.kind == MATERIAL_COATEDDIFFUSE) return diffuse_lobe_eval(b.color0, wo, wi, pdf);
    return conductor_lobe_eval(b.color0, b.color1, b.alpha_base, b.flags, wo, wi, pdf);
}

FN bool base_sample(IN(Bsdf) b, vec3 wo, vec2 u, INOUT(BsdfSample) s) {
    if (b.kind == MATERIAL_COATEDDIFFUSE) return diffuse_lobe_sample(b.color0, wo, u, s);
    return conductor_lobe_sample(b.color0, b.color1, b.alpha_base, b.flags, wo, u, s);
}

// ---- Helpers ---------------------------------------------------------------------------------------------------------

// Zeros of both signs must hash equally.
FN uint hash_direction(vec3 w) {
    uint x = w.x == 0.0f ? 0u : floatBitsToUint(w.x);
    uint y = w.y == 0.0f ? 0u : floatBitsToUint(w.y);
    return hash_combine(hash_combine(x, y), floatBitsToUint(w.z));
}
FN vec2 rng_float2(INOUT(Rng) rng) {
    float x = rng_float(rng);
    float y = rng_float(rng);
    return vec2(x, y);
}

// Fraction that crosses the height dz of the medium along w without being scattered.
FN float layer_transmittance(float dz, vec3 w) { return exp_of(-min(abs(dz) / max(abs(w.z), MIN_COSINE), 100.0f)); }

// Moves along w from height z to the next event: true if the medium scatters there, false at a boundary.
FN bool layer_advance(IN(Bsdf) b, bool has_medium, vec3 w, INOUT(float) z, INOUT(Spectrum) weight, INOUT(Rng) rng) {
    float target = w.z > 0.0f ? b.thickness : 0.0f;
    if (!has_medium) {
        weight = weight * layer_transmittance(b.thickness, w);
        z = target;
        return false;
    }
    float dz = sample_exponential(rng_float(rng), 1.0f) * abs(w.z);
    float next = w.z > 0.0f ? z + dz : z - dz;
    bool scattered = next > 0.0f && next < b.thickness;
    z = scattered ? next : target;
    return scattered;
}

// ---- The walk --------------------------------------------------------------------------------------------------------

// Jobs of layered_scatter.
// LAYERED_SAMPLE: a direction, by a walk that samples one at every event. f includes the walk's weight, and pdf is the
// last event's density: their quotient is unbiased, but neither is a value or density of the whole coat.
// LAYERED_VALUE: f(wo, wi), by walks from wo (refracted in) that are connected to wi at every event.
// LAYERED_DENSITY: the density of wi, or of the sampled direction if there is one. It assumes that light leaves after at
// most one reflection at the base, which is estimated with one sample of each direction inside. A tenth of it is the
// uniform density, for everything else (pbrt, 4th edition, section 14.3.4).
CONST uint LAYERED_SAMPLE = 1u;
CONST uint LAYERED_VALUE = 2u;
CONST uint LAYERED_DENSITY = 4u;

// One of `jobs`, for directions above the coat: the value; or the density in all channels; or 1 if s is a sample, else 0. The first
// steps of a walk refract wo in, and wi, if there is one. Jobs that are not requested are known when a kernel is compiled, so that
// their code is removed.
//
// Where light leaves the coat along w, the event's density is weighted against that of the direction refracted in from
// wi. With MATERIAL_EXACT_COAT, the latter is the density of sampling -w from wi. pbrt uses the density of sampling wi
// from -w instead, so that the two weights do not sum to 1, and values of rough coats are too bright: by 8 % over a
// white diffuse base at alpha = 0.3. Images can only agree with pbrt's by doing the same, so this is the default. (f is
// reciprocal between the transport modes: one evaluation serves both directions.)
INLINED_FN Spectrum layered_walks(IN(Bsdf) b, vec3 wo, vec3 wi, float uc, vec2 u, uint transport, uint job, uint jobs,
                                  uint hash_o, uint hash_i, INOUT(BsdfSample) s) {
    bool sampling = (jobs & LAYERED_SAMPLE) != 0u && job == LAYERED_SAMPLE;
    bool valuing = (jobs & LAYERED_VALUE) != 0u && job == LAYERED_VALUE;
    bool weighing = (jobs & LAYERED_DENSITY) != 0u && job == LAYERED_DENSITY;
    bool coat_specular = dielectric_lobe_is_specular(b.alpha, b.eta);
    bool base_specular = base_is_specular(b);
    bool has_medium = !is_black(b.albedo);
    Rng rng = weighing ? rng_begin(hash_i, hash_o) : rng_begin(hash_o + b.walk, hash_i);
    uint entries = sampling ? 1u : 2u;
    uint steps = entries + (weighing ? 1u : b.max_depth);
    uint walks = sampling ? 1u : b.samples;
    Spectrum surface = Spectrum(0.0f);  // the coat's reflection; a density has the same number in all channels
    Spectrum sum = Spectrum(0.0f);
    for (uint walk = 0u; walk < walks; ++walk) {
        Spectrum beta = Spectrum(1.0f);
        vec3 w = wo;
        float z = b.thickness;
        bool specular = true;
        bool entered = true;
        vec3 exit_w = wi;  // wi, refracted in
        Spectrum exit_weight = Spectrum(0.0f);
        float exit_pdf = 0.0f;
        for (uint step = 0u; step < steps; ++step) {
            if (sampling && step == entries) rng = rng_begin(hash_o, hash_direction(vec3(uc, u.x, u.y)));
            bool entering = step < entries;
            bool at_coat = entering;
            bool scattered = false;
            if (!entering && !weighing) {
                float largest = max_value(beta);
                if (step - entries > 3u && largest < 0.25f) {
                    if (!(rng_float(rng) < largest)) break;
                    beta = beta / largest;
                }
                scattered = layer_advance(b, has_medium, w, z, beta, rng);
                at_coat = !scattered && z > 0.0f;
            }
            // At the base, or in the medium at height z: adds light that arrives along exit_w, if this event can
            // scatter it into the walk ...
            float event_pdf = 0.0f;
            float arrived = 0.0f;
            if (!at_coat && !sampling) {
                Spectrum reflected = Spectrum(0.0f);
                if (scattered) {
                    event_pdf = henyey_greenstein(-dot3(w, -exit_w), b.g);
                    reflected = b.albedo * event_pdf;
                } else if (!base_specular) {
                    reflected = base_eval(b, -w, -exit_w, event_pdf) * abs(exit_w.z);
                }
                float share = coat_specular ? 1.0f : power_heuristic(exit_pdf, event_pdf);
                arrived = share * event_pdf;
                if (valuing) {
                    float reached = share * layer_transmittance(b.thickness - z, exit_w);
                    sum = sum + beta * reflected * exit_weight * reached;
                }
                if (weighing && coat_specular) {
                    sum = sum + Spectrum(arrived);
                    break;
                }
            }
            // ... and the walk continues in a direction sampled by the event.
            BsdfSample event = no_bsdf_sample();
            bool goes_on = true;
            if (at_coat) {
                // Unless sampling, only reflections at the inner side continue: light that leaves is added where
                // its direction was sampled.
                float uc_event = uc;
                vec2 u_event = u;
                if (!sampling || !entering) {
                    uc_event = rng_float(rng);
                    u_event = rng_float2(rng);
                }
                vec3 from = !entering ? -w : (step == 0u ? wo : wi);
                uint lobes = sampling ? LOBE_BOTH_SIDES : (entering ? LOBE_TRANSMISSION : LOBE_REFLECTION);
                uint flow = entering && step == 1u ? 1u - transport : transport;
                goes_on = dielectric_lobe_sample(b.alpha, b.eta, from, uc_event, u_event, flow, lobes, event);
            } else {
                vec2 u_event = rng_float2(rng);
                if (scattered) {
                    event.wi = sample_henyey_greenstein(-w, b.g, u_event);
                    if (!sampling) event_pdf = henyey_greenstein(-dot3(w, event.wi), b.g);
                    goes_on = !is_grazing(event.wi);
                    event.lobe = LOBE_REFLECTION | LOBE_GLOSSY;
                } else {
                    goes_on = base_sample(b, -w, u_event, event);
                    event_pdf = event.pdf;
                }
            }
            entered = entered && goes_on;
            if (sampling) {
                if (!goes_on || (!scattered && !entering && (!(event.pdf > 0.0f) || is_black(event.f)))) break;
                specular = specular && (event.lobe & LOBE_SPECULAR) != 0u;
                bool transmitted = (event.lobe & LOBE_TRANSMISSION) != 0u;
                if (transmitted != entering) {
                    s.wi = event.wi;
                    s.f = beta * event.f;
                    s.pdf = event.pdf;
                    s.lobe = LOBE_REFLECTION | (specular ? LOBE_SPECULAR : LOBE_GLOSSY);
                    s.pdf_is_proportional = 1u;
                    return Spectrum(1.0f);
                }
            } else if (!entering && !goes_on) {
                break;
            }
            if (scattered) {
                beta = beta * b.albedo;
                w = event.wi;
            } else if (step == 1u && !sampling) {
                if (!entered) break;
                exit_w = event.wi;
                exit_pdf = event.pdf;
                exit_weight = event.f / event.pdf;
            } else if (goes_on) {
                beta = beta * event.f * (abs(event.wi.z) / event.pdf);
                w = event.wi;
            }
            if (sampling) continue;
            // The coat's reflection, and light that leaves the coat.
            bool outside = step == 0u;
            bool leaves = !at_coat && !coat_specular && (weighing || w.z > 0.0f);
            if (leaves || (outside && walk == 0u)) {
                bool exact = !outside && valuing && (b.flags & MATERIAL_EXACT_COAT) != 0u;
                vec3 from = outside ? wo : (exact ? wi : -w);
                vec3 to = exact ? -w : wi;
                uint lobes = LOBE_BOTH_SIDES;
                if (outside && weighing) lobes = LOBE_REFLECTION;
                if (!outside && valuing) lobes = LOBE_TRANSMISSION;
                float pdf;
                Spectrum f =
                    dielectric_lobe_eval(b.alpha, b.eta, from, to, exact ? 1u - transport : transport, lobes, pdf);
                if (outside) {
                    surface = weighing ? Spectrum(pdf) : f;
                } else if (weighing) {
                    sum = sum + Spectrum(base_specular ? pdf : arrived + power_heuristic(event_pdf, pdf) * pdf);
                } else {
                    float share = !scattered && base_specular ? 1.0f : power_heuristic(event_pdf, pdf);
                    sum = sum + beta * f * (share * layer_transmittance(b.thickness - z, w));
                }
            }
            if (!at_coat && !(max_value(beta) > 0.0f)) break;
        }
    }
    if (weighing) return Spectrum(0.1f * INV_FOUR_PI + 0.9f * (surface[0] + sum[0] / float(b.samples)));
    return sampling ? Spectrum(0.0f) : surface + sum / float(b.samples);
}

#if SEPARATE_FUNCTIONS
RARE_FN bool layered_sample(IN(Bsdf) b, vec3 wo, float uc, vec2 u, uint transport, uint hash_o, INOUT(BsdfSample) s) {
    return !is_black(layered_walks(b, wo, wo, uc, u, transport, LAYERED_SAMPLE, LAYERED_SAMPLE, hash_o, 0u, s));
}
RARE_FN Spectrum layered_value(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, uint hash_o, uint hash_i) {
    BsdfSample none = no_bsdf_sample();
    return layered_walks(b, wo, wi, 0.0f, vec2(0.0f), transport, LAYERED_VALUE, LAYERED_VALUE, hash_o, hash_i, none);
}
RARE_FN float layered_density(IN(Bsdf) b, vec3 wo, vec3 wi, uint transport, uint hash_o, uint hash_i) {
    BsdfSample none = no_bsdf_sample();
    return layered_walks(b, wo, wi, 0.0f, vec2(0.0f), transport, LAYERED_DENSITY, LAYERED_DENSITY, hash_o, hash_i,
                         none)[0];
}
#endif

// Does all of `jobs`; true if a direction was sampled. GLSL compilers inline every call, and with a walk per job a kernel took
// minutes to compile: for them, one loop has the only call. C++ compilers make a function of each job, which takes a seventh fewer
// instructions than one for all.
FN bool layered_scatter(IN(Bsdf) b, vec3 wo_any, vec3 wi_any, float uc, vec2 u, uint transport, uint jobs,
                        INOUT(BsdfSample) s, OUT(Spectrum) value, OUT(float) density) {
    value = Spectrum(0.0f);
    density = 0.0f;
    bool below = wo_any.z < 0.0f;
    vec3 wo = below ? -wo_any : wo_any;
    vec3 wi = below ? -wi_any : wi_any;
    if (is_grazing(wo)) return false;
    bool found = false;
    uint hash_o = hash_direction(wo);
#if SEPARATE_FUNCTIONS
    if ((jobs & LAYERED_SAMPLE) != 0u) {
        found = layered_sample(b, wo, uc, u, transport, hash_o, s);
        if (!found) return false;
        wi = s.wi;
    }
    if (wi.z >= MIN_COSINE && (jobs & (LAYERED_VALUE | LAYERED_DENSITY)) != 0u) {
        uint hash_i = hash_direction(wi);
        if ((jobs & LAYERED_VALUE) != 0u) value = layered_value(b, wo, wi, transport, hash_o, hash_i);
        if ((jobs & LAYERED_DENSITY) != 0u) density = layered_density(b, wo, wi, transport, hash_o, hash_i);
    }
#else
    for (uint job = LAYERED_SAMPLE; job <= LAYERED_DENSITY; job += job) {
        if ((jobs & job) == 0u) continue;
        if (job != LAYERED_SAMPLE && !(wi.z >= MIN_COSINE)) break;
        Spectrum result = layered_walks(b, wo, wi, uc, u, transport, job, jobs, hash_o, hash_direction(wi), s);
        if ((jobs & LAYERED_SAMPLE) != 0u && job == LAYERED_SAMPLE) {
            found = !is_black(result);
            if (!found) break;
            wi = s.wi;
        }
        if (job == LAYERED_VALUE) value = result;
        if (job == LAYERED_DENSITY) density = result[0];
    }
#endif
    if (found && below) s.wi = -s.wi;
    return found;
}

#endif

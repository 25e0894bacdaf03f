// Coats: a dielectric interface over a diffuse or metallic base, with an optional scattering medium between, by a random
// walk through the layers at every evaluation (pbrt, 4th edition, section 14.3; Guo et al. 2018, "Position-Free Monte
// Carlo Simulation for Arbitrary Layered BSDFs"). Values are unbiased estimates (up to max_depth) that are functions of
// the two directions: their random numbers are keyed by the directions' bits. Densities are pbrt's approximations.
//
// Both sides show the coat (pbrt's twoSided): everything is turned so that wo.z > 0. The coat's interface is at height
// `thickness`, the base at 0; the medium's extinction is 1. The base transmits nothing.
#ifndef LAMPYRIS_KERNEL_BSDF_LAYERED
#define LAMPYRIS_KERNEL_BSDF_LAYERED

// ---- The base --------------------------------------------------------------------------------------------------------

FN bool base_is_specular(IN(Bsdf) b) { return b.kind == MATERIAL_COATED_CONDUCTOR && ggx_is_smooth(b.alpha_base); }

FN vec3 base_eval(IN(Bsdf) b, vec3 wo, vec3 wi, OUT(float) pdf) {
    if (b.kind == MATERIAL_COATED_DIFFUSE) return diffuse_eval(b.color0, wo, wi, pdf);
    return conductor_eval(b.color0, b.color1, b.alpha_base, b.flags, wo, wi, pdf);
}

FN bool base_sample(IN(Bsdf) b, vec3 wo, vec2 u, INOUT(BsdfSample) s) {
    if (b.kind == MATERIAL_COATED_DIFFUSE) return diffuse_sample(b.color0, wo, u, s);
    return conductor_sample(b.color0, b.color1, b.alpha_base, b.flags, wo, u, s);
}

// ---- Small things ----------------------------------------------------------------------------------------------------

// Zeros of either sign are the same direction.
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

// Share that crosses the height dz of the medium unscattered along w.
FN float layer_transmittance(float dz, vec3 w) { return exp_of(-min(abs(dz) / max(abs(w.z), MIN_COSINE), 100.0f)); }

// Sampling the coat's interface with numbers of the walk.
FN bool coat_sample(IN(Bsdf) b, vec3 wo, uint transport, uint lobes, INOUT(Rng) rng, INOUT(BsdfSample) s) {
    s = no_bsdf_sample();
    float uc = rng_float(rng);
    vec2 u = rng_float2(rng);
    return dielectric_sample(b.alpha, b.eta, wo, uc, u, transport, lobes, s);
}

// How far along w the walk is from height z when the medium scatters it: false if it reaches a boundary, at height z then.
FN bool layer_advance(IN(Bsdf) b, bool has_medium, vec3 w, INOUT(float) z, INOUT(vec3) weight, INOUT(Rng) rng) {
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

// Refraction of w, travelling up inside, to wi outside; and the density for weighing w against wis, which was sampled by
// refracting in from wi: the density of that, if MATERIAL_EXACT_COAT. pbrt takes the density of choosing wi from inside, so
// that the two weights do not sum to 1, and a rough coat's values come out too bright: 8 % over a white diffuse base at
// alpha = 0.3. Images can only agree with pbrt's by doing the same, so this is the default. (f is reciprocal between the
// transport modes: one evaluation serves either way.)
FN vec3 layered_exit(IN(Bsdf) b, vec3 w, vec3 wi, uint transport, OUT(float) pdf) {
    bool exact = (b.flags & MATERIAL_EXACT_COAT) != 0u;
    vec3 from = exact ? wi : -w;
    vec3 to = exact ? -w : wi;
    return dielectric_eval(b.alpha, b.eta, from, to, exact ? 1u - transport : transport, LOBE_TRANSMISSION, pdf);
}

// ---- Evaluation ------------------------------------------------------------------------------------------------------

// One walk from wos (the direction refracted in from wo, weighted) towards wi; wis is sampled by refracting in from wi.
FN vec3 layered_walk(IN(Bsdf) b, IN(BsdfSample) wos, IN(BsdfSample) wis, vec3 wi, uint transport, INOUT(Rng) rng) {
    bool coat_specular = dielectric_is_specular(b.alpha, b.eta);
    bool base_specular = base_is_specular(b);
    bool has_medium = !is_black(b.albedo);
    vec3 sum = vec3(0.0f);
    vec3 beta = wos.f * (abs(wos.wi.z) / wos.pdf);
    vec3 exit_weight = wis.f / wis.pdf;
    vec3 w = wos.wi;
    float z = b.thickness;
    for (uint depth = 0u; depth < b.max_depth; ++depth) {
        float largest = max_component(beta);
        if (depth > 3u && largest < 0.25f) {
            if (!(rng_float(rng) < largest)) break;
            beta = beta / largest;
        }
        bool scattered = layer_advance(b, has_medium, w, z, beta, rng);
        if (!scattered && z > 0.0f) {
            // Inner side of the coat: only its reflection goes on, leaving is accounted for where the direction was chosen.
            BsdfSample s;
            if (!coat_sample(b, -w, transport, LOBE_REFLECTION, rng, s)) break;
            beta = beta * s.f * (abs(s.wi.z) / s.pdf);
            w = s.wi;
            continue;
        }
        // The base, or the medium at height z: light arrives along wis, if this event can scatter it there ...
        float event_pdf = 0.0f;
        vec3 event = vec3(0.0f);
        if (scattered) {
            event_pdf = henyey_greenstein(-dot3(w, -wis.wi), b.g);
            event = b.albedo * event_pdf;
        } else if (!base_specular) {
            event = base_eval(b, -w, -wis.wi, event_pdf) * abs(wis.wi.z);
        }
        float share = coat_specular ? 1.0f : power_heuristic(wis.pdf, event_pdf);
        sum = sum + beta * event * exit_weight * (share * layer_transmittance(b.thickness - z, wis.wi));
        // ... and the walk goes on in a direction chosen by the event.
        vec2 u = rng_float2(rng);
        if (scattered) {
            vec3 next = sample_henyey_greenstein(-w, b.g, u);
            event_pdf = henyey_greenstein(-dot3(w, next), b.g);
            w = next;
            beta = beta * b.albedo;
            if (is_grazing(w)) break;
        } else {
            BsdfSample s = no_bsdf_sample();
            if (!base_sample(b, -w, u, s)) break;
            beta = beta * s.f * (abs(s.wi.z) / s.pdf);
            w = s.wi;
            event_pdf = s.pdf;
        }
        if (!coat_specular && w.z > 0.0f) {
            float exit_pdf;
            vec3 exit_f = layered_exit(b, w, wi, transport, exit_pdf);
            float exit_share = !scattered && base_specular ? 1.0f : power_heuristic(event_pdf, exit_pdf);
            sum = sum + beta * exit_f * (exit_share * layer_transmittance(b.thickness - z, w));
        }
        if (!(max_component(beta) > 0.0f)) break;
    }
    return sum;
}

RARE_FN vec3 layered_eval(IN(Bsdf) b, vec3 wo_any, vec3 wi_any, uint transport) {
    vec3 wo = wo_any.z < 0.0f ? -wo_any : wo_any;
    vec3 wi = wo_any.z < 0.0f ? -wi_any : wi_any;
    if (is_grazing(wo) || !(wi.z >= MIN_COSINE)) return vec3(0.0f);
    float pdf;
    vec3 surface = dielectric_eval(b.alpha, b.eta, wo, wi, transport, LOBE_BOTH_SIDES, pdf);
    Rng rng = rng_begin(hash_direction(wo) + b.walk, hash_direction(wi));
    vec3 sum = vec3(0.0f);
    for (uint walk = 0u; walk < b.samples; ++walk) {
        BsdfSample wos;
        BsdfSample wis;
        bool in_o = coat_sample(b, wo, transport, LOBE_TRANSMISSION, rng, wos);
        bool in_i = coat_sample(b, wi, 1u - transport, LOBE_TRANSMISSION, rng, wis);
        if (in_o && in_i) sum = sum + layered_walk(b, wos, wis, wi, transport, rng);
    }
    return surface + sum / float(b.samples);
}

// Density of the layers as if light left after at most one reflection at the base, estimated by one sample of each
// direction inside, mixed with a tenth of the uniform density for all else (pbrt, 4th edition, section 14.3.4).
RARE_FN float layered_pdf(IN(Bsdf) b, vec3 wo_any, vec3 wi_any, uint transport) {
    vec3 wo = wo_any.z < 0.0f ? -wo_any : wo_any;
    vec3 wi = wo_any.z < 0.0f ? -wi_any : wi_any;
    if (is_grazing(wo) || !(wi.z >= MIN_COSINE)) return 0.0f;
    bool coat_specular = dielectric_is_specular(b.alpha, b.eta);
    float reflection;
    dielectric_eval(b.alpha, b.eta, wo, wi, transport, LOBE_REFLECTION, reflection);
    Rng rng = rng_begin(hash_direction(wi), hash_direction(wo));
    float sum = 0.0f;
    for (uint walk = 0u; walk < b.samples; ++walk) {
        BsdfSample wos;
        BsdfSample wis;
        bool in_o = coat_sample(b, wo, transport, LOBE_TRANSMISSION, rng, wos);
        bool in_i = coat_sample(b, wi, 1u - transport, LOBE_TRANSMISSION, rng, wis);
        if (!in_o || !in_i) continue;
        float base_pdf;
        base_eval(b, -wos.wi, -wis.wi, base_pdf);
        if (coat_specular) {
            sum += base_pdf;
            continue;
        }
        BsdfSample up = no_bsdf_sample();
        if (!base_sample(b, -wos.wi, rng_float2(rng), up)) continue;
        float coat_pdf;
        dielectric_eval(b.alpha, b.eta, -up.wi, wi, transport, LOBE_BOTH_SIDES, coat_pdf);
        if (base_is_specular(b)) {
            sum += coat_pdf;
        } else {
            sum += power_heuristic(wis.pdf, base_pdf) * base_pdf + power_heuristic(up.pdf, coat_pdf) * coat_pdf;
        }
    }
    return 0.1f * INV_FOUR_PI + 0.9f * (reflection + sum / float(b.samples));
}

// A direction by a walk that chooses at every event. The walk's weight so far goes into f, and the last event's density is
// the pdf: their quotient is unbiased, each alone is not a value or density of the whole.
RARE_FN bool layered_sample(IN(Bsdf) b, vec3 wo_any, float uc, vec2 u, uint transport, INOUT(BsdfSample) s) {
    bool below = wo_any.z < 0.0f;
    vec3 wo = below ? -wo_any : wo_any;
    if (!dielectric_sample(b.alpha, b.eta, wo, uc, u, transport, LOBE_BOTH_SIDES, s)) return false;
    s.pdf_is_proportional = 1u;
    s.eta = 1.0f;
    if ((s.lobe & LOBE_REFLECTION) != 0u) {
        if (below) s.wi = -s.wi;
        return true;
    }
    Rng rng = rng_begin(hash_direction(wo), hash_direction(vec3(uc, u.x, u.y)));
    bool specular = (s.lobe & LOBE_SPECULAR) != 0u;
    bool has_medium = !is_black(b.albedo);
    vec3 beta = s.f * (abs(s.wi.z) / s.pdf);
    vec3 w = s.wi;
    float z = b.thickness;
    for (uint depth = 0u; depth < b.max_depth; ++depth) {
        float largest = max_component(beta);
        if (depth > 3u && largest < 0.25f) {
            if (!(rng_float(rng) < largest)) return false;
            beta = beta / largest;
        }
        if (layer_advance(b, has_medium, w, z, beta, rng)) {
            beta = beta * b.albedo;
            w = sample_henyey_greenstein(-w, b.g, rng_float2(rng));
            specular = false;
            if (is_grazing(w)) return false;
            continue;
        }
        BsdfSample event = no_bsdf_sample();
        if (z > 0.0f) {
            if (!coat_sample(b, -w, transport, LOBE_BOTH_SIDES, rng, event)) return false;
        } else if (!base_sample(b, -w, rng_float2(rng), event)) {
            return false;
        }
        if (!(event.pdf > 0.0f) || is_black(event.f)) return false;
        specular = specular && (event.lobe & LOBE_SPECULAR) != 0u;
        w = event.wi;
        if ((event.lobe & LOBE_TRANSMISSION) != 0u) {
            s.wi = below ? -w : w;
            s.f = beta * event.f;
            s.pdf = event.pdf;
            s.lobe = LOBE_REFLECTION | (specular ? LOBE_SPECULAR : LOBE_GLOSSY);
            return true;
        }
        beta = beta * event.f * (abs(w.z) / event.pdf);
    }
    return false;
}

#endif

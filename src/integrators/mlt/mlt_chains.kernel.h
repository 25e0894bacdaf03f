// Chains of paths (Metropolis and others 1953; Veach and Guibas 1997, "Metropolis Light Transport"), in primary sample space.
#include "core/kernel/scene.h"

#include "core/kernel/film.h"
#include "integrators/bidirectional/bidirectional_layout.h"
#include "integrators/mlt/mlt_layout.h"

BUFFER_RO(0, FilmWindow, window)
BUFFER_RO(1, BidirectionalPass, passes)
BUFFER_RO(2, MltPass, mlt)
BUFFER_RW(3, uint, splats)
BUFFER_RW(4, uint, counters)
BUFFER_RW(5, MltState, states)    // of chains
BUFFER_RW(7, float, luminances)   // of seeds
BUFFER_RO(8, uint, chosen)        // of each chain: its seed
BUFFER_RO(9, uint, depth_starts)  // the first seed of each number of scattering vertices

#include "core/kernel/splat.h"
#include "integrators/mlt/mlt_path.h"

// A chain's path in the log, which counts `times`: the probability of being the chain's next one, summed over mutations.
RARE_FN void log_chain_splat(vec3 color, float times) {
    PathLogRecord r = log_record(LOG_SPLAT);
    r.value = color;
    r.factor = times;
    r.extra = times;
    log_write(r);
}

RARE_FN void log_mutation(uint number, int depth, float luminance, float chance) {
    PathLogRecord r = log_record(LOG_MUTATION);
    r.depth = number;
    r.s = uint(mlt_vertices_from_light(depth));
    r.t = uint(depth) + 2u - r.s;
    r.detail = primary_large[0];
    r.pdf = luminance;
    r.extra = chance;
    log_write(r);
}

// Whether the path may be splatted to the window, which is one pixel in a replay.
FN bool mlt_reaches_window(IN(MltSample) path) {
    if (!(path.luminance > 0.0f)) return false;
    FilmWindow w = window[0];
    float margin_x = path.one_pixel != 0u ? 0.0f : scene[0].camera.filter_radius_x;
    float margin_y = path.one_pixel != 0u ? 0.0f : scene[0].camera.filter_radius_y;
    return path.raster.x >= float(w.x) - margin_x && path.raster.x < float(w.x + w.width) + margin_x &&
           path.raster.y >= float(w.y) - margin_y && path.raster.y < float(w.y + w.height) + margin_y;
}

// Adds a path to the picture.
FN void mlt_splat(vec3 color, vec2 raster, bool one_pixel, float weight, uint key) {
    if (!(weight > 0.0f)) return;
    float filter_weight = 1.0f;
    ivec2 pixel = ivec2(int(raster.x), int(raster.y));
    if (!one_pixel) {
        vec2 u = vec2(unit_float(hash_combine(key, 1u)), unit_float(hash_combine(key, 2u)));
        pixel = splat_pixel(raster, u, filter_weight);
    }
    FilmWindow w = window[0];
    int x = pixel.x - int(w.x);
    int y = pixel.y - int(w.y);
    if (x < 0 || y < 0 || x >= int(w.width) || y >= int(w.height)) return;
    PATH_LOG(log_chain_splat(color * filter_weight, weight));
    splat_add(uint(y) * w.width + uint(x), color * (weight * filter_weight), mlt[0].quantum, key);
}
FN void mlt_splat_state(IN(MltState) state, uint key) {
    mlt_splat(state.color, state.raster, state.kind >> 16u != 0u, state.weight, key);
}

// The number of scattering vertices of a seed's path.
FN uint seed_depth(uint seed) {
    uint low = 0u;
    uint high = mlt[0].depths;
    while (low + 1u < high) {
        uint middle = (low + high) / 2u;
        if (depth_starts[middle] <= seed)
            low = middle;
        else
            high = middle;
    }
    return low + uint(MLT_LEAST_DEPTH);
}

KERNEL(mlt_chains) {
    MltPass pass = mlt[0];
    bool mutates = pass.mode == MLT_MUTATE;
    uint seed = pass.mode == MLT_SEEDS ? index : chosen[index];
    MltState state;
    state.color = vec3(0.0f);
    state.luminance = 0.0f;
    state.raster = vec2(0.0f);
    state.weight = 0.0f;
    state.kind = seed_depth(seed);
    if (mutates) state = states[index];
    uint dimensions = mlt_dimensions(state.kind & 0xffffu);
    uint large_steps = 0u;
    uint large_accepted = 0u;
    uint small_accepted = 0u;
    primary_chain[0] = index;
    uint end = mutates ? pass.iterations : 1u;
    uint i = 0u;
    bool follows = false;  // for the path log: a path that reaches the pixel is made twice, and logged the second time
    for (; i < end; ++i) {
        uint number = mutates ? pass.first + i + 1u : 0u;
        PATH_LOG(log_path(LOG_CHAIN, index, number << 12u));
        if (LOGS_PATHS) {
            if (!follows) log_pauses();
        }
        uint key = hash_combine(hash32(pass.seed), seed);  // of a seed
        float u_accept = 0.0f;
        primary_large[0] = 1u;
        if (mutates) {
            key = hash_combine(hash_combine(hash32(pass.seed ^ 0x5bd1e995u), index), pass.first + i);
            primary_large[0] = unit_float(hash_combine(key, 3u)) < pass.large_step ? 1u : 0u;
            u_accept = unit_float(hash_combine(key, 4u));
            large_steps += primary_large[0];
        }
        primary_key[0] = key;
        MltSample proposed = mlt_sample(int(state.kind & 0xffffu));
        if (LOGS_PATHS) {
            follows = !follows && pass.mode != MLT_SEEDS && mlt_reaches_window(proposed);
            if (follows) {
                large_steps -= mutates ? primary_large[0] : 0u;
                i -= 1u;
                continue;
            }
        }
        float acceptance = 1.0f;
        if (mutates) {
            // A proposal that is black or not finite is rejected, and the current path counts.
            acceptance = proposed.luminance > 0.0f ? min(proposed.luminance / state.luminance, 1.0f) : 0.0f;
            state.weight += 1.0f - acceptance;
        }
        PATH_LOG(log_mutation(number, int(state.kind & 0xffffu), proposed.luminance, acceptance));
        if (u_accept < acceptance) {
            if (mutates) {
                mlt_splat_state(state, key);
                large_accepted += primary_large[0];
                small_accepted += 1u - primary_large[0];
            }
            if (pass.mode != MLT_SEEDS) primary_accept(dimensions);
            state.color = proposed.luminance > 0.0f ? proposed.color / proposed.luminance : vec3(0.0f);
            state.luminance = proposed.luminance;
            state.raster = proposed.raster;
            state.kind = (state.kind & 0xffffu) | proposed.one_pixel << 16u;
            state.weight = mutates ? acceptance : 0.0f;
        } else if (acceptance > 0.0f) {
            mlt_splat(proposed.color / proposed.luminance, proposed.raster, proposed.one_pixel != 0u, acceptance, key);
        }
    }
    if (i != end) REPORT_UNFINISHED();
    if (pass.mode == MLT_SEEDS) {
        luminances[index] = state.luminance;
    } else {
        if (mutates) {
            mlt_splat_state(state, hash_combine(primary_key[0], 5u));
            state.weight = 0.0f;
        }
        states[index] = state;
    }
    ATOMIC_ADD_U32(counters[MLT_RAYS], traced_rays[0]);
    if (mutates) {
        ATOMIC_ADD_U32(counters[MLT_LARGE_STEPS], large_steps);
        ATOMIC_ADD_U32(counters[MLT_LARGE_ACCEPTED], large_accepted);
        ATOMIC_ADD_U32(counters[MLT_SMALL_ACCEPTED], small_accepted);
    }
}

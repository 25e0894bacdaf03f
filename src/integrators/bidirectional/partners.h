// The vertices of light paths to which a camera path's vertex is connected, one after the other. The kernel declares `passes`,
// `vertices` and `last_vertices`.
#ifndef LAMPYRIS_PARTNERS
#define LAMPYRIS_PARTNERS

#include "integrators/bidirectional/path_vertex.h"
#include "integrators/bidirectional/weights.h"

struct Partners {
    uint bits;  // random: which of them
    int depth;  // of the camera path's vertex, from 1
    // The last one that was found.
    uint found;
    uint light_path;
    // How many there are on average for each vertex of a light path.
    float chance;
    // Of one light path: the next vertex to look at, and how many it has up to the first that is near enough.
    uint slot;
    uint count;
    // Of the cache: the next depth, and which of its light paths.
    int at;
    uint turn;
};

FN Partners partners_begin(uint light_path, int depth, uint bits) {
    BidirectionalPass pass = passes[0];
    Partners p;
    p.bits = bits;
    p.depth = depth;
    p.found = NONE;
    p.light_path = light_path;
    p.chance = pass.cache != 0u ? float(pass.cache) : 1.0f;
    p.slot = last_vertices[light_path - pass.first_path];
    p.count = 0u;
    p.at = 1;
    p.turn = 0u;
    return p;
}

// All vertices of the light path that leave the path at most maxdepth scattering vertices, or `connections` of them, each with the same
// probability.
FN bool next_of_path(INOUT(Partners) p) {
    BidirectionalPass pass = passes[0];
    for (uint turn = 0u; p.slot != NONE && turn < 65536u; ++turn) {
        PathVertexRecord y = vertices[p.slot];
        p.found = p.slot;
        p.slot = path_vertex_previous(y);
        if (path_vertex_depth(y) + p.depth > pass.maxdepth) continue;
        if (!strategy_wanted(path_vertex_depth(y) + 1, p.depth + 1)) continue;
        uint rank = path_vertex_rank(y);
        if (p.count == 0u) {
            p.count = rank;
            if (pass.connections > 0 && uint(pass.connections) < rank) p.chance = float(pass.connections) / float(rank);
        }
        // Systematic sampling: of `count` vertices, those at which floor(rank chance + u) grows.
        float u = unit_float(p.bits);
        if (p.chance < 1.0f && floor(float(rank) * p.chance + u) == floor(float(rank - 1u) * p.chance + u)) continue;
        return true;
    }
    return false;
}

// The vertex of a light path at a depth, or NONE where it has none that can be connected.
FN uint light_vertex_at(uint light_path, int depth) {
    uint slot = last_vertices[light_path - passes[0].first_path];
    for (uint turn = 0u; slot != NONE && turn < 65536u; ++turn) {
        PathVertexRecord y = vertices[slot];
        if (path_vertex_depth(y) <= depth) return path_vertex_depth(y) == depth ? slot : NONE;
        slot = path_vertex_previous(y);
    }
    return NONE;
}

// The part's light vertices at large (Davidovic, Krivanek, Hasan and Slusallek 2014, "Progressive Light Transport Simulation on the
// GPU": the light vertex cache): at each depth, those of `cache` paths, each of them chosen anew. Every vertex has the same chance, and
// where a light path differs between devices, only the pixels that chose it do.
FN bool next_of_cache(INOUT(Partners) p) {
    BidirectionalPass pass = passes[0];
    int deepest = min(pass.maxdepth - p.depth, pass.deepest);
    while (p.at <= deepest) {
        int depth = p.at;
        uint choice = hash_combine(p.bits, uint(depth) * pass.cache + p.turn);
        p.turn += 1u;
        if (p.turn == pass.cache) {
            p.turn = 0u;
            p.at += 1;
        }
        if (!strategy_wanted(depth + 1, p.depth + 1)) continue;
        p.light_path = pass.first_path + mul_high(choice, pass.part_paths);
        p.found = light_vertex_at(p.light_path, depth);
        if (p.found != NONE) return true;
    }
    return false;
}

FN bool next_partner(INOUT(Partners) p) {
    if (passes[0].cache != 0u) return next_of_cache(p);
    return next_of_path(p);
}

#endif

// Weights of multiple importance sampling for paths that are built from both ends (Veach 1997, section 10.2), by
// recursion, without arrays of vertices (Georgiev 2012, "Implementing Vertex Connection and Merging").
//
// A path of k scattering vertices can be sampled by strategies (s, t): s vertices from the light, t from the camera. The
// weight of one is 1 / (1 + sum of the other densities over its own), each quotient squared for the power heuristic. Each end of
// a path keeps two sums over the strategies that have fewer vertices from its side:
//     a   the strategy that ends one vertex earlier, over the density of sampling the last vertex from the next one,
//     d   all others, over that density, and over the density of sampling the last but one vertex from the last.
// The two densities are known when the path goes on, or is connected. The report has a third sum for merging; it is d over the
// term of `eta`, the number of light paths times the area within which vertices are merged.
//
// Densities are of positions, per area. They are made of the geometric cosines, because positions are on the true surface,
// and lengths are in units of the scene's radius, so that squares stay within a float's range.
#ifndef LAMPYRIS_MIS
#define LAMPYRIS_MIS

struct MisSums {
    float a;
    float d;
};

CONST uint HEURISTIC_BALANCE = 0u;
CONST uint HEURISTIC_POWER = 1u;

CONST float MIS_LARGEST = 1e30f;       // finite, because its product with a density of 0 is 0
CONST float MIS_LEAST_COSINE = 1e-6f;  // of a vertex that is seen edge-on
// Of a sampled direction (1/sr). Estimated densities (layers) may be 0.
CONST float MIS_LEAST_DENSITY = 1e-12f;

// A quotient of densities, as the heuristic counts it.
FN float mis_term(float quotient, uint heuristic) {
    return heuristic == HEURISTIC_POWER ? quotient * quotient : quotient;
}

FN float mis_cosine(float cosine) { return max(abs(cosine), MIS_LEAST_COSINE); }

FN void mis_bound(INOUT(MisSums) m) {
    m.a = min(m.a, MIS_LARGEST);
    m.d = min(m.d, MIS_LARGEST);
}

// The path reaches a vertex, at a squared distance from the previous one (1 after a start at infinity, or of an orthographic
// camera), under a geometric cosine.
FN void mis_arrive(INOUT(MisSums) m, float squared_distance, float cosine, uint heuristic) {
    float inverse = 1.0f / mis_term(mis_cosine(cosine), heuristic);
    m.a = m.a * (mis_term(squared_distance, heuristic) * inverse);
    m.d = m.d * inverse;
    mis_bound(m);
}

// The path goes on from a vertex, in a direction that was sampled with the density `forward` (1/sr). `reverse`: the density, from
// there, of the direction to the previous vertex. `cosine`: geometric, of the new direction. `eta`: of merging (0: none).
FN void mis_scatter(INOUT(MisSums) m, float cosine, float forward, float reverse, float eta, uint heuristic) {
    float earlier = mis_term(eta, heuristic) + m.a + mis_term(reverse, heuristic) * m.d;
    float density = max(forward, MIS_LEAST_DENSITY);
    m.d = mis_term(mis_cosine(cosine) / density, heuristic) * min(earlier, MIS_LARGEST);
    m.a = 1.0f / mis_term(density, heuristic);
    mis_bound(m);
}

// The same for a specular lobe, whose vertex no strategy connects. The probabilities of choosing the lobe are the same in both
// directions. `cosine`: geometric, of the direction to the previous vertex; `eta`: relative index along a refraction.
FN void mis_scatter_specular(INOUT(MisSums) m, float cosine, float eta, uint heuristic) {
    m.d = mis_term(mis_cosine(cosine) / (eta * eta), heuristic) * m.d;
    m.a = 0.0f;
    mis_bound(m);
}

// What one end of a connection adds to the sum: the strategies in which the other end samples this vertex, with the density
// `from_other` (per area), and merging there. `reverse`: the density, at this vertex, of the direction to the previous one.
FN float mis_end(IN(MisSums) m, float from_other, float reverse, float eta, uint heuristic) {
    float earlier = mis_term(eta, heuristic) + m.a + mis_term(reverse, heuristic) * m.d;
    return mis_term(from_other, heuristic) * min(earlier, MIS_LARGEST);
}

// What one of two merged ends adds. `reverse`: as above.
FN float mis_merged_end(IN(MisSums) m, float reverse, float eta, uint heuristic) {
    return min(m.a + mis_term(reverse, heuristic) * m.d, MIS_LARGEST) / mis_term(eta, heuristic);
}

#endif

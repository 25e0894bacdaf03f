// What a walk does, in the path log. walk.h includes it.
#ifndef LAMPYRIS_KERNEL_WALK_LOG
#define LAMPYRIS_KERNEL_WALK_LOG

// Paths from lights start with log_emits.
RARE_FN void log_begins(Walk w) {
    log_now[0].depth = 0u;
    log_now[0].medium = w.medium;
    if (w.transport != TRANSPORT_RADIANCE) return;
    PathLogRecord r = log_record(LOG_START);
    r.position = w.ray.origin;
    r.direction = w.ray.direction;
    r.throughput = rgb_of(w.throughput);
    log_write(r);
}

RARE_FN void log_vertex(Walk w, Surface s, Vertex v) {
    log_now[0].depth = uint(w.depth);
    log_now[0].medium = w.medium;
    log_now[0].position = s.position;
    log_now[0].throughput = rgb_of(w.throughput);
    PathLogRecord r = log_record(LOG_VERTEX);
    r.distance = s.distance;
    r.normal = s.ns;
    r.value = s.ng;
    r.direction = w.ray.direction;
    r.material = v.bsdf.kind;
    r.light = s.light;
    r.partner = s.geometry;
    r.detail = s.primitive;
    log_write(r);
}

// The walk has left vertex number w.depth, if its throughput is not 0.
RARE_FN void log_scatters(Walk w, BsdfSample next, vec3 onward) {
    PathLogRecord r = log_record(LOG_SCATTER);
    r.direction = onward;
    r.pdf = next.pdf;
    r.detail = next.lobe;
    r.extra = next.eta;
    r.throughput = rgb_of(w.throughput);
    log_write(r);
    log_now[0].depth = uint(w.depth);
}

RARE_FN void log_roulette(float chance, bool ends) {
    PathLogRecord r = log_record(LOG_ROULETTE);
    r.depth -= 1u;
    r.extra = chance;
    r.detail = ends ? 1u : 0u;
    log_write(r);
}

RARE_FN void log_escapes(Walk w) {
    PathLogRecord r = log_record(LOG_ESCAPE);
    r.position = w.ray.origin;
    r.direction = w.ray.direction;
    r.throughput = rgb_of(w.throughput);
    log_write(r);
}

#endif

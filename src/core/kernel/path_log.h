// The log of paths, for replays of a pixel: kernels write what happens to a path, the host sorts and prints it.
//
// Calls are statements PATH_LOG(log_...(...)). Nothing is left of them unless the scene's effects have EFFECT_PATH_LOG, which
// only a replay asks for. What a Walk does, and direct_light, is logged already; an integrator logs what else it adds to a pixel.
#ifndef LAMPYRIS_KERNEL_PATH_LOG
#define LAMPYRIS_KERNEL_PATH_LOG

SCENE_RW(BINDING_PATH_LOG, PathLogRecord, path_log)

#define LOGS_PATHS (HAS(EFFECT_PATH_LOG) && RARELY(CALLED_FOR(EFFECT_PATH_LOG)))
#define PATH_LOG(call) \
    if (LOGS_PATHS) {  \
        call;          \
    }

// What the next events have in common.
struct PathLogState {
    uint kind;
    uint path;
    uint order;
    uint depth;
    vec3 position;    // of the last vertex, and
    vec3 throughput;  // what the path carried there
    uint medium;
    uint partner;        // the light path to which the next connections lead, and
    uint partner_depth;  // the number of its vertex, from 1
    float chance;        // of making such a connection
    float weight;        // of the next splat
    uint paused;
};
PRIVATE(PathLogState, log_now, 1)

// The events that follow belong to another path.
RARE_FN void log_path(uint kind, uint path, uint order) {
    log_now[0].kind = kind;
    log_now[0].path = path;
    log_now[0].order = order;
    log_now[0].depth = 0u;
    log_now[0].position = vec3(0.0f);
    log_now[0].throughput = vec3(1.0f);
    log_now[0].medium = 0u;
    log_now[0].partner = NONE;
    log_now[0].partner_depth = 0u;
    log_now[0].chance = 1.0f;
    log_now[0].weight = 1.0f;
    log_now[0].paused = 0u;
}
// Until the next path, only splats are logged.
RARE_FN void log_pauses() { log_now[0].paused = 1u; }
RARE_FN void log_carries(Spectrum throughput) { log_now[0].throughput = rgb_of(throughput); }
RARE_FN void log_at(uint depth) { log_now[0].depth = depth; }
RARE_FN void log_weighs(float weight) { log_now[0].weight = weight; }
RARE_FN void log_partner(uint light_path) { log_now[0].partner = light_path; }
RARE_FN void log_connects(uint partner_depth, float chance) {
    log_now[0].partner_depth = partner_depth;
    log_now[0].chance = chance;
}

RARE_FN PathLogRecord log_record(uint event) {
    PathLogRecord r;
    r.event = event;
    r.kind = log_now[0].kind;
    r.path = log_now[0].path;
    r.order = log_now[0].order;
    r.depth = log_now[0].depth;
    r.s = NONE;
    r.t = NONE;
    r.light = NONE;
    r.partner = NONE;
    r.detail = 0u;
    r.material = NONE;
    r.medium = log_now[0].medium;
    r.position = log_now[0].position;
    r.distance = 0.0f;
    r.normal = vec3(0.0f);
    r.pdf = 0.0f;
    r.direction = vec3(0.0f);
    r.weight = 1.0f;
    r.throughput = log_now[0].throughput;
    r.factor = 1.0f;
    r.value = vec3(0.0f);
    r.extra = 0.0f;
    return r;
}

RARE_FN void log_write(PathLogRecord r) {
    uint mode = path_log[0].path;
    bool of_light_path = r.kind == LOG_LIGHT_PATH && r.event != LOG_SPLAT;
    bool wanted = of_light_path ? mode == LOG_MODE_LIGHT_PATHS : mode == LOG_MODE_PIXEL;
    if (log_now[0].paused != 0u && r.event != LOG_SPLAT) return;
    log_now[0].order += 1u;  // in every mode: a light path that runs again has its events at the same places
    if (!wanted) return;
    uint slot = ATOMIC_ADD_U32(path_log[0].event, 1u);
    // The last place is for the record that closes a camera path: without it, no contribution of the path has a value.
    uint last = path_log[0].kind - 1u;
    if (slot >= last && r.event != LOG_SAMPLE) return;
    path_log[min(slot, last) + 1u] = r;
}

// ---- What a path's contributions become ------------------------------------------------------------------------------

// The factor from `before`, in the largest of its channels, to `after`.
FN float log_quotient(vec3 before, vec3 after) {
    vec3 size = abs(before);
    if (size.x >= size.y && size.x >= size.z) return after.x / before.x;
    return size.y >= size.z ? after.y / before.y : after.z / before.z;
}

// The sum of a camera path's contributions, `radiance`, enters the pixel as `value`. Black ones do as the film's unit says.
RARE_FN void log_sample(uint kind, uint path, Spectrum radiance, vec3 value, float of_black) {
    log_now[0].kind = kind;
    log_now[0].path = path;
    log_now[0].order = LOG_ORDER_SAMPLE;
    PathLogRecord r = log_record(LOG_SAMPLE);
    r.value = rgb_of(radiance);
    r.factor = is_black(radiance) ? of_black : log_quotient(rgb_of(radiance), value);
    log_write(r);
}

// Contributions of this path so far are those of another.
RARE_FN void log_discards() { log_write(log_record(LOG_DISCARD)); }

// ---- Light that a path finds -----------------------------------------------------------------------------------------

// Emission of the surface at s, which the path's ray hit; `value`: the path's throughput times it.
RARE_FN void log_emission(Surface s, Spectrum value, float weight) {
    if (is_black(value)) return;
    PathLogRecord r = log_record(LOG_EMISSION);
    r.s = 0u;
    r.t = r.depth + 2u;
    r.light = s.light;
    r.position = s.position;
    r.normal = s.ng;
    r.distance = s.distance;
    r.value = rgb_of(value);
    r.weight = weight;
    log_write(r);
}

// The same for infinite lights.
RARE_FN void log_environment(vec3 direction, Spectrum value, float weight) {
    if (is_black(value)) return;
    PathLogRecord r = log_record(LOG_EMISSION);
    r.s = 0u;
    r.t = r.depth + 2u;
    r.direction = direction;
    r.distance = INFINITE_DISTANCE;
    r.value = rgb_of(value);
    r.weight = weight;
    log_write(r);
}

// The path goes straight on through a mask or an interface, into `medium`.
RARE_FN void log_passes(vec3 position, float distance, uint medium, uint kind) {
    PathLogRecord r = log_record(LOG_PASS);
    r.position = position;
    r.distance = distance;
    r.medium = medium;
    r.detail = kind;
    log_write(r);
}

#endif

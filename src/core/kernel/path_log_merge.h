// Photons in the path log.
#ifndef LAMPYRIS_KERNEL_PATH_LOG_MERGE
#define LAMPYRIS_KERNEL_PATH_LOG_MERGE

#include "core/kernel/photon.h"

// A photon that is merged with the vertex number `depth` + 1 of a camera path. `value`: its contribution without the weight;
// s: vertices of its path, or NONE; `count`: photons that it stands for.
RARE_FN void log_merge(uint path, uint depth, uint s, PhotonRecord photon, Spectrum value, float weight, float count) {
    log_now[0].path = path;
    log_now[0].order = LOG_ORDER_MERGE;
    PathLogRecord r = log_record(LOG_MERGE);
    uint key = photon.place.w;
    r.depth = depth;
    r.s = s;
    r.t = s == NONE ? NONE : depth + 2u;
    r.partner = path_log[0].order + key % max(path_log[0].depth, 1u);
    r.detail = key / max(path_log[0].depth, 1u);
    r.position = photon_position(photon);
    r.direction = photon_direction(photon);
    r.throughput = rgb_of(photon_power(photon));
    r.value = rgb_of(value);
    r.weight = weight;
    r.extra = count;
    log_write(r);
}

#endif

// Photons and photon grids, shared by the host and kernels (core/kernel/photon.h has the functions).
#ifndef LAMPYRIS_KERNEL_PHOTON_LAYOUT
#define LAMPYRIS_KERNEL_PHOTON_LAYOUT

// One photon, 32 bytes. All members are integers, because a float variable may change bits that are not a number's.
struct PhotonRecord {
    // Position (bits of three floats); w: key, a function of (path, bounce), unique among the photons of a build.
    uvec4 place;
    uvec4 flux;  // x: octahedral direction of flight; yzw: power (bits of three floats)
};

// A grid's cells, hashed or not: see core/kernel/photon_grid.h. The host computes it (core/photons/photon_grid.h).
struct PhotonGrid {
    vec4 origin;       // corner of cell (0, 0, 0); w: 1 / side of a cell
    uvec4 resolution;  // cells along x, y, z; w: seed of the hash
    uint count;        // number of photons
    uint entries;      // size of the structure's table
    uint capacity;     // maximum number of photons per entry, in structures that have a limit
    uint option;       // its meaning depends on the structure
};
// Cell coordinates are smaller, so that floats represent them exactly.
CONST uint GRID_MAX_CELLS = 8388608u;

#endif

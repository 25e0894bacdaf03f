// Photons and the grids over them, as the host and kernels share them (core/kernel/photon.h has the functions).
#ifndef LAMPYRIS_KERNEL_PHOTON_LAYOUT
#define LAMPYRIS_KERNEL_PHOTON_LAYOUT

// One photon, 32 bytes. Everything is a word: numbers whose bits are no float must not pass through one.
struct PhotonRecord {
    uvec4
        place;  // position (three floats' bits); w: key, a function of (path, bounce) and unique among the photons of a build
    uvec4 flux;  // x: octahedral direction of flight; power in yzw (three floats' bits)
};

// Cells of a grid, hashed or not: see core/kernel/photon_grid.h. Made by the host (core/photons/photon_grid.h).
struct PhotonGrid {
    vec4 origin;       // corner of cell (0, 0, 0); w: 1 / side of a cell
    uvec4 resolution;  // cells along x, y, z; w: seed of the hash
    uint count;        // of photons
    uint entries;      // of the structure's table
    uint capacity;     // photons that an entry has room for, in structures that have a limit
    uint option;       // the structure's own
};
// Coordinates of cells stay below it, so that a float tells them apart.
CONST uint GRID_MAX_CELLS = 8388608u;

#endif

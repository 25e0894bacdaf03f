// Chooses how each large node is split.
#include "accel/photons/kd_tree/kd_tree_layout.h"

BUFFER_RO(0, KdArgs, arguments)
BUFFER_RW(1, KdLarge, larges)

KERNEL(kd_tree_shape) {
    KdLarge large = larges[index];
    kd_shape(large, arguments[0].round);
    larges[index] = large;
}

// For random_test: the pairs of numbers of a path's samples, by group. Invocation: (pixel * samples + sample) * groups + group.
#include "core/kernel/prelude.h"
#include "core/kernel/layout.h"
#include "core/kernel/random.h"

struct RandomProbe {
    uint kind;  // SAMPLER_*
    uint samples;
    uint groups;
    uint seed;
};

BUFFER_RO(0, RandomProbe, probe)
BUFFER_RW(1, uvec4, numbers)

KERNEL(random_probe) {
    RandomProbe p = probe[0];
    uint group = index % p.groups;
    uint of_pixel = index / p.groups;
    Sampler s = sampler_begin(of_pixel / p.samples, of_pixel % p.samples, p.seed, p.kind);
    numbers[index] = sample_bits_joined_2d_2d_at(s, 8u * group, group);
}

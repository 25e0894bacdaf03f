// Parameters of an integrator or a photon map, declared once for both compilers:
//     #define AO_PARAMS(P) P(int, rays, 1, 1, 1024, "occlusion rays per camera hit") ...
//     PARAMS(AoParams, AO_PARAMS)
// A parameter is P(type, name, default, minimum, maximum, documentation); type is int, uint or float. The host
// generates its specs from the same list with PARAMETER_FIELDS (core/base/parameters.h).
#ifndef LAMPYRIS_KERNEL_PARAMS
#define LAMPYRIS_KERNEL_PARAMS

#define LAMPYRIS_PARAMETER_MEMBER(type, name, default_value, low, high, doc) type name;
#define PARAMS(S, LIST)                 \
    struct S {                          \
        LIST(LAMPYRIS_PARAMETER_MEMBER) \
    };

#endif

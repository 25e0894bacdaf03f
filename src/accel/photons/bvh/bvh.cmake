lampyris_kernel(bvh_ray_query.gather.h GLSL_ONLY)

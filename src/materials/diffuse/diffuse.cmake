lampyris_material(diffuse RANK 10)

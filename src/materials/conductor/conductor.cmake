lampyris_material(conductor RANK 20 EFFECT conductor COST "complex Fresnel terms")

lampyris_material(coatedconductor RANK 70 RARELY SCATTERS_AS coat ESTIMATES EFFECT layered-coat)  # the effect of coateddiffuse

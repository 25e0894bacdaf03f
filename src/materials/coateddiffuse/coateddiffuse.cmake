lampyris_material(coateddiffuse RANK 60 RARELY SCATTERS_AS coat ESTIMATES EFFECT layered-coat
  COST "a random walk between layers for each evaluation and sample")

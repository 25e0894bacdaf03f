lampyris_material(dielectric RANK 30 EFFECT dielectric
  COST "reflection and refraction, paths through glass are longer")

lampyris_material(thindielectric RANK 40 EFFECT thin-dielectric COST "a pane's reflection and transmission")

lampyris_material(orennayar RANK 200 EFFECT oren-nayar COST "a quotient for each evaluation")

lampyris_material(diffusetransmission RANK 50 EFFECT diffuse-transmission COST "a second diffuse lobe")

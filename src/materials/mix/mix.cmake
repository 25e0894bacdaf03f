# core/kernel/material.h replaces it by one of its materials before any other function is called.
lampyris_material(mix RANK 80 SCATTERS_NOTHING EFFECT material-mix COST "picks one of two materials at every hit")

# Walks pass it without evaluating its scattering.
lampyris_material(interface RANK 0 SCATTERS_NOTHING EFFECT interface
  COST "surfaces that only bound a medium: another ray per crossing")

# Walks pass it before they ask what it scatters.
lampyris_material(interface RANK 0 SCATTERS_NOTHING EFFECT interface
  COST "surfaces that only bound a medium: another ray per crossing")

"""What the generators of scenes build their meshes with: numpy and the standard library, nothing else."""

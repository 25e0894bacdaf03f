"""What the benchmarks share: building and running programs, and scenes of any size."""

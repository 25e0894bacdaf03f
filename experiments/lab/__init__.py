"""What the experiments share: runs and their keys, results, statistics, figures, and sections of the report."""

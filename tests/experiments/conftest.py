"""Tests of the experiments import their modules as the experiments do: `from lab.page import build_page`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent.parent / "experiments"))

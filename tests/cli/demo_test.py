"""./dev demo's second half, with one pass: the table, the images and a page that needs nothing else."""

import json
import os
import re
import subprocess
import sys
from html.parser import HTMLParser

import pytest

FIGURES = 8  # four pictures, the error maps of the CPU's two, the reference, the difference of the backends


class Page(HTMLParser):
    """The page's pictures: those within a figure, and others."""

    def __init__(self):
        super().__init__()
        self.open, self.shown, self.loose = 0, 0, 0

    def handle_starttag(self, tag, attributes):
        self.open += tag == "figure"
        self.shown += tag == "img" and self.open
        self.loose += tag == "img" and not self.open

    def handle_endtag(self, tag):
        self.open -= tag == "figure"


# `users`: with lavapipe as they have it; ./dev test makes it compile faster.
@pytest.mark.parametrize("drivers", ["test", pytest.param("users", marks=pytest.mark.long)])
def test_the_demo_writes_images_figures_and_a_page(source_dir, program, tmp_path, drivers):
    script = source_dir / "tools/demo.py"
    command = [sys.executable, script, "--program", program, "--output", tmp_path, "--passes", "1"]
    of_tests = ["GALLIVM_PERF", "LP_NATIVE_VECTOR_WIDTH"] if drivers == "users" else []
    environment = {name: value for name, value in os.environ.items() if name not in of_tests}
    done = subprocess.run(command, capture_output=True, text=True, timeout=280, check=False, env=environment)
    assert done.returncode == 0, done.stderr
    for row in ["rendering", "passes", "photon paths", "relMSE", "FLIP"]:
        assert len(re.findall(rf"^{row} +(?:[\d.]+(?: [sM])? +){{4}}", done.stdout, flags=re.MULTILINE)) == 1
    equal = float(re.search(r"([\d.]+)% of the pixels are equal to the bit", done.stdout)[1])
    assert equal >= 99.9  # design: rays that meet a shared edge are all that differs

    for backend in ["cpu", "vulkan"]:
        for method in ["path", "sppm"]:
            name = f"{method}-{backend}"
            assert json.loads((tmp_path / f"{name}.json").read_text())["passes"] == 1
            for suffix in ["exr", "png"]:
                assert (tmp_path / f"{name}.{suffix}").stat().st_size > 1000

    text = (tmp_path / "index.html").read_text()
    assert not re.search(r"""(src|href)=["'](?!data:)""", text)  # nothing is loaded from elsewhere
    assert not re.search(r"\$[a-z]", text)  # the template was filled in completely
    assert "dielectric" in text
    page = Page()
    page.feed(text)
    assert (page.shown, page.loose) == (FIGURES, 0)

"""./dev demo's second half, with one sample per pixel: the table, the images and a page that needs nothing else."""

import json
import re
import subprocess
import sys


def test_the_demo_writes_images_figures_and_a_page(source_dir, program, tmp_path):
    script = source_dir / "tools/demo.py"
    command = [sys.executable, script, "--program", program, "--output", tmp_path, "--spp", "1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=280, check=False)
    assert done.returncode == 0, done.stderr
    for row in ["rendering", "rays per second", "relMSE", "FLIP"]:
        assert re.search(rf"^{row} ", done.stdout, flags=re.MULTILINE)
    equal = float(re.search(r"([\d.]+)% of the pixels are equal to the bit", done.stdout)[1])
    assert equal >= 99.9  # at one sample per pixel, where rays that meet a shared edge are all that differs

    for backend in ["cpu", "vulkan"]:
        assert json.loads((tmp_path / f"{backend}.json").read_text())["samples_per_pixel"] == 1
        for suffix in ["exr", "png"]:
            assert (tmp_path / f"{backend}.{suffix}").stat().st_size > 1000

    page = (tmp_path / "index.html").read_text()
    assert page.count("data:image/png;base64,") == 5
    assert not re.search(r"""(src|href)=["'](?!data:)""", page)  # nothing is loaded from elsewhere
    assert not re.search(r"\$[a-z]", page)  # no place in the template was left empty
    assert "dielectric" in page

"""docs/reference/README.md equals the program's description of its plugins: a change to one requires the other."""

import re
import subprocess
import sys


def test_the_reference_page_is_what_the_program_says(source_dir, program):
    # Without the machine's own plugins.
    said = subprocess.run(
        [program, "plugins", "--markdown"], env={}, capture_output=True, text=True, timeout=60, check=True
    )
    page = source_dir / "docs/reference/README.md"
    assert page.read_text() == said.stdout, f"write it anew: {program} plugins --markdown > {page}"


def test_the_page_of_kernel_functions_is_what_the_headers_say(source_dir):
    tool = source_dir / "tools/kernel_functions.py"
    said = subprocess.run([sys.executable, tool], capture_output=True, text=True, timeout=60, check=True).stdout
    page = source_dir / "docs/reference/kernel-functions.md"
    assert page.read_text() == said, f"write it anew: python3 {tool} > {page}"
    # None is missing: there are as many as lines that begin with FN.
    kernels = source_dir / "src/core/kernel"
    materials = source_dir / "src/materials"
    left_out = {"prelude.h", "cpp_kernel.h", "trace_bvh2.h", "trace_ray_query.h"}
    texts = [path.read_text() for path in kernels.glob("*.h") if path.name not in left_out]
    texts += [path.read_text() for path in materials.rglob("*.h*")]
    defined = sum(len(re.findall(r"^(?:RARE_|INLINED_)?FN ", text, re.MULTILINE)) for text in texts)
    assert said.count("\n- `") == defined > 300
    for name in ("intersect_scene", "camera_sample", "film_add", "sample_2d", "pow_of", "dot3"):  # the plugin guide's
        assert re.search(rf"^- `\w+ {name}\(", said, re.MULTILINE), name

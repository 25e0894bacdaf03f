"""docs/reference/README.md is what the program says of its plugins; who changes one changes the other."""

import subprocess


def test_the_reference_page_is_what_the_program_says(source_dir, program):
    # Without the machine's own plugins.
    said = subprocess.run(
        [program, "plugins", "--markdown"], env={}, capture_output=True, text=True, timeout=60, check=True
    )
    page = source_dir / "docs/reference/README.md"
    assert page.read_text() == said.stdout, f"write it anew: {program} plugins --markdown > {page}"

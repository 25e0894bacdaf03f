"""The commands in the README and the guides work, word for word, and links lead to existing targets."""

import os
import re
import shutil
import subprocess

import pytest


def blocks(path):
    return re.findall(r"^```sh\n(.*?)^```$", path.read_text(), flags=re.MULTILINE | re.DOTALL)


def run_shell(script, folder, environment):
    return subprocess.run(
        ["bash", "-euxc", script],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=600,
        check=False,
    )


@pytest.fixture
def workplace(source_dir, build_dir, tmp_path):
    """A folder that looks like the checkout, where commands may write: the program is in PATH, too."""
    (tmp_path / "scenes").symlink_to(source_dir / "scenes")
    (tmp_path / "build").mkdir()
    (tmp_path / "build/release").symlink_to(build_dir)
    return tmp_path, os.environ | {"PATH": f"{build_dir}:{os.environ['PATH']}"}


def test_the_user_guides_commands_work(source_dir, workplace):
    script = "".join(blocks(source_dir / "docs/guide.md"))
    assert script.count("lampyris ") > 10
    done = run_shell(script, *workplace)
    assert done.returncode == 0, done.stderr[-3000:]


def test_the_readmes_commands_work(source_dir, workplace):
    first, program, _ = blocks(source_dir / "README.md")
    # The first two set up and build: this test runs inside the second.
    assert first == "./dev demo\n./dev test\n"
    assert program.count("build/release/lampyris") == 4
    done = run_shell(program, *workplace)
    assert done.returncode == 0, done.stderr[-3000:]


def test_building_without_dev_names_presets_that_exist(source_dir):
    for page in ["README.md", "docs/building.md"]:
        text = (source_dir / page).read_text()
        assert "$(./dev packages build)" in text
        for kind in ["", "build "]:
            listed = subprocess.run(
                ["cmake", f"--list-presets={kind.strip() or 'configure'}"],
                cwd=source_dir,
                capture_output=True,
                text=True,
                check=True,
            ).stdout
            assert '"release"' in listed


def pages(source_dir):
    tracked = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "*.md"],
        cwd=source_dir,
        capture_output=True,
        text=True,
        check=True,
    )
    return [source_dir / name for name in tracked.stdout.splitlines() if (source_dir / name).exists()]


@pytest.mark.skipif(not shutil.which("git"), reason="an unpacked archive has no list of its files")
def test_links_lead_to_files(source_dir):
    missing = [
        f"{page.relative_to(source_dir)}: {target}"
        for page in pages(source_dir)
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text())
        if "://" not in target and not (page.parent / target).exists()
    ]
    assert missing == []

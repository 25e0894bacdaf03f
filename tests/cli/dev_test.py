"""./dev itself: its output, its errors, and that a second run has nothing to set up."""

import re
import subprocess
import sys
import time

import pytest


def dev(source_dir, *arguments):
    return subprocess.run(
        [source_dir / "dev", *arguments],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        timeout=60,
        check=False,
    )


@pytest.mark.parametrize("arguments", [["--help"], ["-h"], ["help"], ["test", "--help"], ["--no-setup", "help"]])
def test_help_names_every_command(source_dir, arguments):
    done = dev(source_dir, *arguments)
    assert done.returncode == 0
    assert done.stderr == ""
    for command in ["demo", "test", "build", "bench", "reproduce", "format", "lint", "packages"]:
        assert f"\n  {command} " in done.stdout


def test_without_a_command_the_help_goes_to_standard_error(source_dir):
    done = dev(source_dir)
    assert done.returncode == 1
    assert done.stdout == ""
    assert "Usage:" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["frobnicate"], "unknown command 'frobnicate'; there are: build test demo"),
        (["--frobnicate", "build"], "unknown option '--frobnicate'"),
        (["build", "fast"], "unknown kind 'fast'; there are release, debug and asan"),
        (["build", "--fast"], "build: unknown option '--fast'"),
        (["build", "release", "--fast"], "build: unknown option '--fast'"),
        (["build", "release", "all", "fast"], "build: unknown option 'fast'"),
        (["test", "--short"], "test: unknown option '--short'"),
        (["test", "-R"], "test: -R needs a regular expression"),
        (["bench", "-x"], "bench: unknown option '-x'"),
        (["reproduce", "--half"], "reproduce: unknown option '--half'"),
        (["format", "--hard"], "format: unknown option '--hard'"),
        (["packages", "gui"], "unknown group 'gui'; there are: build test bench develop"),
    ],
)
def test_a_wrong_word_is_told(source_dir, arguments, message):
    done = dev(source_dir, *arguments)
    assert done.returncode == 1
    assert done.stdout == ""
    assert message in done.stderr


def test_packages_are_listed_by_group_and_only_once(source_dir):
    build = dev(source_dir, "packages", "build").stdout.split()
    everything = dev(source_dir, "packages").stdout.split()
    assert "openimageio-tools" in build
    assert "clang-tidy" not in build
    assert set(build) < set(everything)
    assert len(everything) == len(set(everything))


def test_set_up_is_quick_and_silent_when_all_is_there(source_dir):
    """./dev test has set everything up before this test runs, so another check must take nearly no time."""
    script = (
        f"cd {source_dir} && say() {{ echo SAID; }} && fail() {{ exit 1; }} && . tools/setup.sh"
        " && setup_packages build test && setup_venv"
    )
    start = time.monotonic()
    done = subprocess.run(["bash", "-euc", script], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert time.monotonic() - start < 10.0  # 0.1 s on an idle machine; the tests share theirs


CLASSIC = """# a comment
deb-src http://mirror.test/debian bookworm main
deb [arch=amd64 signed-by=/k.gpg] http://mirror.test/debian bookworm main
"""
DEB822 = """Types: deb
URIs: http://mirror.test/debian-security
Suites: bookworm-security
Components: main

Types: deb deb-src
URIs: http://mirror.test/debian
Suites: bookworm bookworm-updates
Components: main contrib
Signed-By: /k.gpg
"""


@pytest.mark.parametrize(("name", "text"), [("sources.list", CLASSIC), ("sources.list.d/debian.sources", DEB822)])
def test_the_backports_source_follows_the_machines_own_sources(source_dir, tmp_path, name, text):
    (tmp_path / "sources.list.d").mkdir()
    (tmp_path / name).write_text(text)
    script = f"cd {source_dir} && . tools/setup.sh && apt_sources={tmp_path} backports_source"
    done = subprocess.run(["bash", "-euc", script], capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout.splitlines() == [
        "Types: deb",
        "URIs: http://mirror.test/debian",
        "Suites: bookworm-backports",
        "Components: main",
        "Signed-By: /k.gpg",
    ], done.stderr


def test_a_machine_without_bookworm_gets_no_backports_source(source_dir, tmp_path):
    (tmp_path / "sources.list").write_text("deb http://mirror.test/debian trixie main\n")
    script = f"cd {source_dir} && . tools/setup.sh && apt_sources={tmp_path} backports_source"
    done = subprocess.run(["bash", "-uc", script], capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == ""
    assert done.returncode == 1


def test_the_shell_scripts_pass_shellcheck(source_dir):
    scripts = ["dev", ".ci/run", *(str(path.relative_to(source_dir)) for path in source_dir.glob("tools/*.sh"))]
    done = subprocess.run(
        ["shellcheck", "-x", *scripts], cwd=source_dir, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.stdout == ""
    assert done.returncode == 0


@pytest.mark.parametrize("arguments", [["check"], ["format", "--check"]])
def test_the_python_files_pass_ruff(source_dir, arguments):
    ruff = [sys.executable, "-m", "ruff", *arguments, "--no-cache", "--quiet", "."]
    done = subprocess.run(ruff, cwd=source_dir, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize(
    ("arguments", "listed"),
    [
        (["reproduce", "--list"], "random_points"),
        (["reproduce", "--list", "--full"], "curves"),
        (["bench", "--list"], "rays"),
    ],
)
def test_lists_need_no_build(source_dir, arguments, listed):
    done = dev(source_dir, *arguments)
    assert done.returncode == 0, done.stderr
    assert re.search(rf"^{listed} +\S", done.stdout, re.MULTILINE)
    assert done.stderr == ""  # set-up and building are reported there

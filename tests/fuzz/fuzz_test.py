"""Build the libFuzzer targets and fuzz: LAMPYRIS_FUZZ_SECONDS in all (CI: a minute), or a few seconds."""

import os
import shutil
import subprocess

import pytest

TARGETS = ("parse", "ply", "scene", "checkpoint", "cache", "options")
ALL_TARGETS = (*TARGETS, "image")  # most of what reads images is in libraries, whose faults come by chance
# OpenImageIO leaks the texts of errors.
ENVIRONMENT = {"image": {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}}
SECONDS = int(os.environ.get("LAMPYRIS_FUZZ_SECONDS", "14"))
LONG_SECONDS = 600  # a target

pytestmark = pytest.mark.skipif(shutil.which("clang++") is None, reason="libFuzzer comes with clang")


@pytest.fixture(scope="module")
def fuzz_build(source_dir):
    build = source_dir / "build/fuzz-parser"
    configure = ["cmake", "-S", source_dir / "tests/fuzz", "-B", build, "-G", "Ninja", "-DCMAKE_CXX_COMPILER=clang++"]
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", build], check=True, stdout=subprocess.DEVNULL)
    return build


def fuzz(build, source_dir, corpus, target, seconds):
    # A fresh folder comes first: new inputs go there, not into the tree's corpus.
    folder = source_dir / "tests/fuzz"
    dictionaries = {"parse": "pbrt.dict", "scene": "pbrt.dict", "ply": "ply.dict"}
    dictionary = [f"-dict={folder / dictionaries[target]}"] if target in dictionaries else []
    limits = [f"-max_total_time={seconds}", "-rss_limit_mb=1024", "-timeout=20", "-max_len=4096"]
    command = [build / f"{target}_fuzz", *limits, *dictionary, f"-artifact_prefix={build}/", corpus]
    run = subprocess.run(
        [*command, folder / "corpus" / target],
        capture_output=True,
        text=True,
        check=False,
        env=ENVIRONMENT.get(target),
    )
    assert run.returncode == 0, f"finding left in {build}:\n{run.stderr[-4000:]}"
    assert "DONE" in run.stderr


@pytest.mark.parametrize("target", TARGETS)
def test_finds_nothing(fuzz_build, source_dir, tmp_path, target):
    fuzz(fuzz_build, source_dir, tmp_path, target, SECONDS // len(TARGETS))


@pytest.mark.long
@pytest.mark.parametrize("target", ALL_TARGETS)
def test_finds_nothing_in_minutes(fuzz_build, source_dir, tmp_path, target):
    fuzz(fuzz_build, source_dir, tmp_path, target, LONG_SECONDS)


def test_the_seeds_are_read(fuzz_build, source_dir):
    """The corpus is read without a finding, and is not empty, or else the fuzzer would start from nothing."""
    for target in ALL_TARGETS:
        seeds = sorted((source_dir / "tests/fuzz/corpus" / target).iterdir())
        assert len(seeds) >= 5
        command = [fuzz_build / f"{target}_fuzz", f"-artifact_prefix={fuzz_build}/", *seeds]
        subprocess.run(command, check=True, capture_output=True, env=ENVIRONMENT.get(target))

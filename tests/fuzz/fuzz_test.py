"""Build the libFuzzer targets and fuzz: with --long, or as CI does, for LAMPYRIS_FUZZ_SECONDS in all."""

import os
import shutil
import subprocess

import pytest

TARGETS = ("parse", "ply")
# Behind --long: they are linked to the builder of scenes, which takes minutes to compile with sanitizers. (Most of what
# reads images is in libraries, whose faults come by chance.)
ALL_TARGETS = (*TARGETS, "scene", "checkpoint", "cache", "options", "image")
# OpenImageIO leaks the texts of errors.
ENVIRONMENT = {"image": {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}}
SECONDS = int(os.environ.get("LAMPYRIS_FUZZ_SECONDS", "6"))
LONG_SECONDS = 600  # a target

# Building the targets takes a minute: without a time for it, with --long alone.
BY_DEFAULT = "LAMPYRIS_FUZZ_SECONDS" in os.environ
FEW = [pytest.param(target, marks=() if BY_DEFAULT else pytest.mark.long) for target in TARGETS]

pytestmark = pytest.mark.skipif(shutil.which("clang++") is None, reason="libFuzzer comes with clang")


@pytest.fixture(scope="module")
def fuzz_build(source_dir):
    build = source_dir / "build/fuzz-parser"
    configure = ["cmake", "-S", source_dir / "tests/fuzz", "-B", build, "-G", "Ninja", "-DCMAKE_CXX_COMPILER=clang++"]
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    targets = [f"{target}_fuzz" for target in TARGETS]
    subprocess.run(["cmake", "--build", build, "--target", *targets], check=True, stdout=subprocess.DEVNULL)
    return build


@pytest.fixture(scope="module")
def whole_fuzz_build(fuzz_build):
    subprocess.run(["cmake", "--build", fuzz_build], check=True, stdout=subprocess.DEVNULL)
    return fuzz_build


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


@pytest.mark.parametrize("target", FEW)
def test_finds_nothing(fuzz_build, source_dir, tmp_path, target):
    fuzz(fuzz_build, source_dir, tmp_path, target, SECONDS // len(TARGETS))


@pytest.mark.long
@pytest.mark.parametrize("target", ALL_TARGETS)
def test_finds_nothing_in_minutes(whole_fuzz_build, source_dir, tmp_path, target):
    fuzz(whole_fuzz_build, source_dir, tmp_path, target, LONG_SECONDS)


def expect_seeds_are_read(build, source_dir, target):
    """The corpus is read without a finding, and is not empty, or else the fuzzer would start from nothing."""
    seeds = sorted((source_dir / "tests/fuzz/corpus" / target).iterdir())
    assert len(seeds) >= 5
    command = [build / f"{target}_fuzz", f"-artifact_prefix={build}/", *seeds]
    subprocess.run(command, check=True, capture_output=True, env=ENVIRONMENT.get(target))


@pytest.mark.parametrize("target", FEW)
def test_the_seeds_are_read(fuzz_build, source_dir, target):
    expect_seeds_are_read(fuzz_build, source_dir, target)


@pytest.mark.long
@pytest.mark.parametrize("target", [target for target in ALL_TARGETS if target not in TARGETS])
def test_the_seeds_of_the_others_are_read(whole_fuzz_build, source_dir, target):
    expect_seeds_are_read(whole_fuzz_build, source_dir, target)

"""lampyris bench photon-maps: the keys that scripts rely on; the programs of bench/ compile."""

import json
import os
import shlex
import subprocess
from pathlib import Path

import pytest


@pytest.fixture
def run(program):
    def call(*arguments):
        return subprocess.run([program, *arguments], capture_output=True, text=True, timeout=120, check=False)

    return call


def test_json_has_the_keys_of_the_contract(run):
    result = run(
        "bench",
        "photon-maps",
        "--structures",
        "sorted_grid,stochastic_hash:slots=2",
        "--points",
        "1e3,2000",
        "--distribution",
        "planar",
        "--queries",
        "500",
        "--seconds",
        "0",
        "--json",
    )
    assert result.returncode == 0, result.stderr
    data = json.loads(result.stdout)
    assert data["schema"] == "lampyris.photon-bench/1"
    assert data["floor"]["scatter_ns"] > 0 and data["floor"]["atomic_ns"] > 0
    assert len(data["rows"]) == 4
    for row in data["rows"]:
        assert set(row) == {
            "structure",
            "parameters",
            "backend",
            "points",
            "distribution",
            "construction_ns_per_point",
            "floor_ns_per_point",
            "query_ns",
            "bytes_per_point",
            "photons_found_mean",
        }
        assert row["floor_ns_per_point"] > 0
        assert row["construction_ns_per_point"] > 0 and row["query_ns"] > 0
    assert data["rows"][1]["parameters"]["slots"] == "2"
    assert data["rows"][0]["points"] == 1000 and data["rows"][3]["points"] == 2000
    # An exact map and an unbiased one find about the same number: ten per query were requested, some beyond the edge.
    assert 7 < data["rows"][2]["photons_found_mean"] < 11
    assert 7 < data["rows"][3]["photons_found_mean"] < 11


def test_table_by_default(run):
    structures = "sorted_grid,stochastic_hash:slots=2,table_size=0.5"
    result = run("bench", "photon-maps", "--structures", structures, "--points", "1000", "--seconds", "0")
    assert result.returncode == 0, result.stderr
    assert "random scatter" in result.stdout and "sorted_grid" in result.stdout
    assert "stochastic_hash:slots=2,table_size=0.5" in result.stdout


def test_errors_say_what_is_valid(run):
    for arguments, message in [
        (["--structures", "sorted_gird"], 'did you mean "sorted_grid"?'),
        (["--points", "many"], "--points many"),
        (["--distribution", "cubic"], "uniform"),
        (["--backend", "volkan"], "vulkan"),
    ]:
        result = run("bench", "photon-maps", *arguments)
        assert result.returncode == 1
        assert message in result.stderr + result.stdout


def test_benches_outside_of_all_compile(source_dir):
    """They are built when somebody measures, so that nothing else notices when what they call has changed."""
    commands = json.loads((Path(os.environ["LAMPYRIS_BUILD_DIR"]) / "compile_commands.json").read_text())
    benches = [one for one in commands if Path(one["file"]).match(f"{source_dir}/bench/*_bench.cpp")]
    assert len(benches) >= 2
    for one in benches:
        words = shlex.split(one["command"])
        words = [word for word in words if word not in ("-c", words[words.index("-o") + 1], "-o")]
        done = subprocess.run(
            [*words, "-fsyntax-only"], cwd=one["directory"], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr

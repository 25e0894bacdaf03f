"""Measure how scenes are read: MB/s of text, seconds for a PLY mesh of ten million triangles, peak memory."""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

GOALS = {
    "parse_text/128/200000": "large meshes: at least 50 MB/s; peak memory below 3x the mesh data",
    "parse_text/64/8": "meshes of 8 vertices: at least 50 MB/s; memory goes into what surrounds the mesh data",
    "ply_ten_million_triangles": "below 2 s beyond a plain read; peak memory below 3x the mesh data",
}


def main() -> None:
    """Run parse_bench, print a table, and write the same as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--build", type=Path, default=Path("build/release"), help="folder with the benchmarks' programs"
    )
    parser.add_argument("--json", type=Path, help="where to write the results")
    arguments = parser.parse_args()
    # Configuring again finds Google Benchmark if it was installed in the meantime.
    subprocess.run(["cmake", arguments.build], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(
        ["cmake", "--build", arguments.build, "--target", "parse_bench"], check=True, stdout=subprocess.DEVNULL
    )
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "result.json"
        command = [arguments.build / "parse_bench", f"--benchmark_out={output}", "--benchmark_out_format=json"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        measured = json.loads(output.read_text())["benchmarks"]

    rows = []
    for entry in measured:
        row = {"name": entry["name"], "cpu_s": entry["cpu_time"] / 1000, "wall_s": entry["real_time"] / 1000}
        row["peak_over_mesh"] = entry["peak/mesh"]
        if "MB/s" in entry:
            row["megabytes_per_cpu_s"] = entry["MB/s"]
        if "plain_read_s" in entry:
            row["plain_read_s"] = entry["plain_read_s"]
        row["goal"] = GOALS[entry["name"]]
        rows.append(row)

    print(f"{'benchmark':32} {'CPU s':>7} {'wall s':>7} {'MB/s':>7} {'plain read s':>13} {'peak/mesh':>10}  goal")
    for row in rows:
        rate = f"{row['megabytes_per_cpu_s']:.0f}" if "megabytes_per_cpu_s" in row else ""
        plain = f"{row['plain_read_s']:.2f}" if "plain_read_s" in row else ""
        print(
            f"{row['name']:32} {row['cpu_s']:7.3f} {row['wall_s']:7.3f} {rate:>7} {plain:>13}"
            f" {row['peak_over_mesh']:10.2f}  {row['goal']}"
        )
    if arguments.json:
        arguments.json.write_text(json.dumps({"schema": "lampyris.bench-parsing/1", "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()

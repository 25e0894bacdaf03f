"""results.md: what was found, as text, and `results-runs.json`: the runs behind its numbers, to be followed.

A row of a table ends with a group, such as r12; the JSON's `groups` names its runs, `runs` has what each of them was
and said.
"""

import gzip
import json
import shutil
from pathlib import Path

from lab.runs import ROOT

SCHEMA = "lampyris.results/1"
TEXT, RUNS = "results.md", "results-runs.json"
PUBLISHED = ROOT / "docs"
_HEAD = """# Results

Made by `./dev reproduce --publish` from the runs of the experiments in [experiments/](../experiments/README.md); do
not edit. The page that `./dev reproduce` leaves in `build/reproduce/index.html` has the same with plots to zoom into
and images to flip between.

Each row of a table, and each verdict, names a group of runs in its last column: `groups` of
[results-runs.json.gz](results-runs.json.gz) lists the group's runs, and `runs` has each one's command, settings and
statistics, as `run.json` of the reproduction has them.

"""
_MACHINE = "## The machine\n\n"


def write_results(folder: Path, sections: list[Path], machine: dict, titles: dict[str, str]) -> None:
    """Write results.md and the runs it rests on into `folder`. `titles`: of experiments, by their folders."""
    groups = _Groups()
    answers = [answer for path in sections if (answer := json.loads(path.read_text()).get("answer"))]
    text = _HEAD + "".join(_table(answer, groups) for answer in answers) + _MACHINE
    text += "".join(f"- {name}: {value}\n" for name, value in machine.items())
    experiment = ""
    figures: dict[Path, str] = {}
    for path in sections:
        section = json.loads(path.read_text())
        if section["experiment"] != experiment:
            experiment = section["experiment"]
            text += f"\n## {titles.get(experiment, experiment)}\n"
        text += _section(section, groups)
        for file in [path.parent / one["file"] for one in section["downloads"] if one["file"].endswith(".png")]:
            figures[file] = _figure_name(section, file)
            text += f"\n![{section['title']}](results/{figures[file]})\n"
    shutil.rmtree(folder / "results", ignore_errors=True)
    (folder / "results").mkdir()
    for file, name in figures.items():
        shutil.copyfile(file, folder / "results" / name)
    (folder / TEXT).write_text(text)
    runs = {key: _compact(json.loads((folder / "runs" / key / "run.json").read_text())) for key in groups.keys_used()}
    content = {"schema": SCHEMA, "groups": groups.members, "runs": runs}
    (folder / RUNS).write_text(json.dumps(content, indent=None, separators=(",", ":")) + "\n")


def publish(folder: Path) -> None:
    """Put a reproduction's results into docs/."""
    shutil.copyfile(folder / TEXT, PUBLISHED / TEXT)
    packed = gzip.compress((folder / RUNS).read_bytes(), mtime=0)
    (PUBLISHED / f"{RUNS}.gz").write_bytes(packed)
    shutil.rmtree(PUBLISHED / "results", ignore_errors=True)
    shutil.copytree(folder / "results", PUBLISHED / "results")


class _Groups:
    """Numbers lists of runs: the same list, the same name."""

    def __init__(self) -> None:
        self.members: dict[str, list[str]] = {}
        self._names: dict[tuple[str, ...], str] = {}

    def name(self, keys: list[str]) -> str:
        """The name of a list of runs; a dash for none."""
        if not keys:
            return "–"
        found = self._names.setdefault(tuple(keys), f"r{len(self._names) + 1}")
        self.members[found] = list(keys)
        return found

    def keys_used(self) -> list[str]:
        """Every run of every group."""
        return sorted({key for keys in self.members.values() for key in keys})


def _figure_name(section: dict, file: Path) -> str:
    return f"{section['experiment']}-{section['name']}-{file.name}".replace("_", "-")


def _section(section: dict, groups: _Groups) -> str:
    text = f"\n### {section['title']}\n\n" + "".join(f"{one}\n\n" for one in section["text"])
    for verdict in section["verdicts"]:
        source = f" ({verdict['source']})" if verdict["source"] else ""
        text += f"- Claim: {verdict['claim']}{source}\n- Measured: {verdict['measured']}\n"
        why = f": {verdict['why']}" if verdict["why"] else ""
        text += f"- **Holds: {verdict['holds']}**{why} [{groups.name(verdict['runs'])}]\n\n"
    return text + "".join(_table(table, groups) for table in section["tables"])


def _table(table: dict, groups: _Groups) -> str:
    heads = [f"{one['title']}, {one['unit']}" if one["unit"] else one["title"] for one in table["columns"]] + ["runs"]
    lines = [_row(heads), _row(["---"] * len(heads))]
    for row in table["rows"]:
        cells = [_cell(row.get(one["key"]), one["digits"]) for one in table["columns"]]
        lines.append(_row([*cells, groups.name(row.get("runs") or [])]))
    caption = f"{table['caption']}\n\n" if table["caption"] else ""
    return f"**{table['title']}**\n\n" + "\n".join(lines) + f"\n\n{caption}"


def _row(cells: list[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _cell(value, digits: int) -> str:
    if value is None or value == "":
        return "–"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    if isinstance(value, int):
        return str(value)
    short = f"{value:.{digits}g}"
    # Plain digits where that is not longer: 1320, not 1.32e+03.
    return f"{float(short):.0f}" if "e+" in short and abs(value) < 1e7 else short


def _compact(record: dict) -> dict:
    """A record without what no number of the results rests on: its curve keeps times, passes and errors."""
    kept = {key: value for key, value in record.items() if key not in {"files", "digest", "inputs"}}
    if "statistics" in kept:
        curve = kept["statistics"].get("convergence") or []
        names = (
            "wall_s",
            "passes",
            "estimated_error",
            "relmse",
            "halving_low_s",
            "halving_high_s",
            "estimate_unstable",
        )
        short = [{name: _rounded(one[name]) for name in names if name in one} for one in curve]
        kept["statistics"] = {**kept["statistics"], "convergence": short}
    return kept


def _rounded(value):
    return float(f"{value:.6g}") if isinstance(value, float) else value

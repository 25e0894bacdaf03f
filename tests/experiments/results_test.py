"""docs/results.md: each number can be traced to its run; this test traces some."""

import gzip
import json
import re

import pytest
from lab.results import RUNS, TEXT, write_results
from lab.sections import Column, Section, Table, Verdict

# Columns whose numbers stand in a single run's record as they are: (where in the record, heading).
FOLLOWED = {
    "relMSE": ("compare", "relmse"),
    "relMSE, trimmed": ("compare", "relmse_trimmed"),
    "MAPE": ("compare", "mape"),
    "estimated relMSE": ("statistics", "estimated_error"),
    "passes": ("statistics", "passes"),
}


def tables(text):
    """Every table of a page of Markdown: its heading, and its rows as dicts by their headings."""
    for heading, block in re.findall(r"^\*\*(.+?)\*\*\n\n((?:\|.*\n)+)", text, flags=re.MULTILINE):
        lines = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in block.splitlines()]
        yield heading, [dict(zip(lines[0], row, strict=True)) for row in lines[2:]]


def shows(text, value):
    """Whether a cell is the value, rounded to as many significant digits as it has: of 291000, three to six."""
    digits = re.sub(r"e.*|\.", "", text).lstrip("-0")
    least = len(digits if "." in text else digits.rstrip("0"))
    return any(float(text) == float(f"{value:.{max(count, 1)}g}") for count in range(least, len(digits) + 1))


@pytest.fixture(scope="module")
def published(source_dir):
    text = (source_dir / "docs" / TEXT).read_text()
    runs = json.loads(gzip.decompress((source_dir / "docs" / f"{RUNS}.gz").read_bytes()))
    return text, runs


def test_every_group_names_runs_that_are_there(published):
    text, told = published
    groups = set(re.findall(r"\| (r\d+) \|$|\[(r\d+)\]$", text, flags=re.MULTILINE))
    named = {name for pair in groups for name in pair if name}
    assert len(named) > 50
    assert named == set(told["groups"])
    for keys in told["groups"].values():
        assert keys
        for key in keys:
            run = told["runs"][key]
            assert run["key"] == key
            assert run["command"][0].endswith("lampyris")


def test_every_row_and_verdict_names_its_runs(published):
    text, _ = published
    found = list(tables(text))
    assert len(found) > 10
    for heading, rows in found:
        for row in rows:
            assert re.fullmatch(r"r\d+", row["runs"]) or heading.startswith("Lines of kernels"), (heading, row)


def test_numbers_are_those_of_their_runs(published):
    text, told = published
    followed = 0
    for heading, rows in tables(text):
        for row in rows:
            keys = told["groups"].get(row["runs"], [])
            if len(keys) != 1:
                continue
            record = told["runs"][keys[0]]
            for title, (part, name) in FOLLOWED.items():
                value = (record.get(part) or {}).get(name)
                if row.get(title, "–") == "–" or value is None:
                    continue
                assert shows(row[title], value), (heading, row, value)
                followed += 1
    assert followed > 40


def test_photon_map_timings_are_those_of_the_benchs_rows(published):
    text, told = published
    followed = 0
    for _, rows in tables(text):
        for row in rows:
            records = [told["runs"][key] for key in told["groups"].get(row["runs"], [])]
            if "construction, ns a point" not in row or not records or row["construction, ns a point"] == "–":
                continue
            points = float(row["points"])
            values = [
                one["construction_ns_per_point"]
                for run in records
                for one in run["bench"]["rows"]
                if one["points"] == points
            ]
            assert any(shows(row["construction, ns a point"], one) for one in values)
            followed += 1
    assert followed >= 20  # ten structures on two backends


def test_the_text_says_what_a_section_says(tmp_path):
    key = "0123456789abcdef0123"
    place = tmp_path / "runs" / key
    place.mkdir(parents=True)
    curve = [{"wall_s": 0.123456789, "passes": 1, "relmse": 0.5, "flip": 0.3}]
    record = {"key": key, "command": ["lampyris"], "statistics": {"passes": 3, "convergence": curve}, "digest": "x"}
    (place / "run.json").write_text(json.dumps(record))
    rows = [{"method": "a|b", "relmse": 0.123456, "runs": [key]}, {"method": "none", "relmse": float("nan")}]
    table = Table(
        "errors", "Errors", [Column("method", "method"), Column("relmse", "relMSE", "1", 2)], rows, "as measured"
    )
    verdict = Verdict("it is fast", "it is", "partly", "not always", "the paper", [key])
    section = Section("one", "A target", "some_experiment", ["What it is."], [verdict], tables=[table])
    section.write(tmp_path / "targets/some_experiment/one")
    path = tmp_path / "targets/some_experiment/one/section.json"
    write_results(tmp_path, [path], {"processor": "a fast one"}, {"some_experiment": "An experiment"})
    text = (tmp_path / TEXT).read_text()
    for said in ["- processor: a fast one", "## An experiment", "### A target", "**Holds: partly**: not always [r1]"]:
        assert said in text
    assert "| a\\|b | 0.12 | r1 |" in text
    assert "| none | – | – |" in text
    told = json.loads((tmp_path / RUNS).read_text())
    assert told["groups"] == {"r1": [key]}
    assert told["runs"][key]["statistics"]["convergence"] == [{"wall_s": 0.123457, "passes": 1, "relmse": 0.5}]

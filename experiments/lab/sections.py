"""What a target hands to the report: text, a verdict, plots, image viewers, tables and downloads, as plain data.

`Section.write` saves it as `section.json` (schema `lampyris.section/1`) beside the target's figures; the page and
docs/results.md are made from these files alone. Every number names the runs it came from by their keys, so that it
can be followed to a run's JSON. Colours are the page's business: a series says which `method` it shows, and one
method has one colour everywhere.
"""

import json
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path

from lab.latex import latex_table

SCHEMA = "lampyris.section/1"
HOLDS = ["yes", "partly", "no", "not tested"]


@dataclass
class Verdict:
    """A claim of the paper (or of theory) beside what was measured here; `holds` is one of HOLDS."""

    claim: str
    measured: str
    holds: str
    why: str = ""  # why not, where it does not hold
    source: str = ""  # where the claim stands
    runs: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.holds not in HOLDS:
            raise ValueError(f"a verdict holds one of {HOLDS}, not '{self.holds}'")


@dataclass
class Axis:
    """An axis of a plot."""

    title: str
    log: bool = False


@dataclass
class Series:
    """A line or a cloud of points: `x`, `y` of equal length, a band `low` to `high` where given.

    `hover` has a text per point (the run's settings), `runs` the keys behind each point: a list of lists.
    `style`: "line", "dash" (predictions and references: no markers) or "points".
    """

    name: str
    method: str
    x: list[float]
    y: list[float]
    low: list[float] | None = None
    high: list[float] | None = None
    hover: list[str] | None = None
    runs: list[list[str]] | None = None
    style: str = "line"


@dataclass
class Plot:
    """A plot; `categories` asks for grouped (or stacked) bars instead of lines: x are their names."""

    id: str
    title: str
    x: Axis
    y: Axis
    series: list[Series]
    bars: str = ""  # "", "group" or "stack"
    caption: str = ""


@dataclass
class Image:
    """An image of a viewer: an EXR (relative to the reproduction's folder), and what made it.

    `errors` may hold relmse, flip, ...; `error_map` and `flip_map` name EXR files (one channel `Y`) of the same size.
    """

    name: str
    method: str
    file: str
    command: str
    run: str = ""
    facts: str = ""  # one line: passes, seconds, photons
    errors: dict[str, float] = field(default_factory=dict)
    error_map: str = ""
    flip_map: str = ""


@dataclass
class Viewer:
    """Images of the same scene and size, to flip between. Viewers with the same `link` pan and zoom together."""

    id: str
    title: str
    images: list[Image]
    reference: str = ""  # the name of the image that the others are compared with
    link: str = ""
    caption: str = ""


@dataclass
class Column:
    """A column: the key in each row, and how to show it. `digits` are significant ones; text is shown as it is."""

    key: str
    title: str
    unit: str = ""
    digits: int = 3


@dataclass
class Table:
    """Rows are dicts of plain values by the columns' keys; `runs` of a row are the keys of the runs behind it."""

    id: str
    title: str
    columns: list[Column]
    rows: list[dict]
    caption: str = ""


@dataclass
class Download:
    """A file beside section.json that a reader may want: data, a figure for a paper."""

    file: str
    label: str


@dataclass
class Figure:
    """A picture beside section.json that the page shows as it is; its file is among the downloads, too."""

    file: str
    title: str


@dataclass
class Section:
    """Everything that one target says. `experiment` is its folder; `text`: paragraphs, plain but for `code`."""

    name: str
    title: str
    experiment: str
    text: list[str] = field(default_factory=list)
    verdicts: list[Verdict] = field(default_factory=list)
    plots: list[Plot] = field(default_factory=list)
    viewers: list[Viewer] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    downloads: list[Download] = field(default_factory=list)
    answer: Table | None = None  # what the page begins with
    figures: list[Figure] = field(default_factory=list)

    def write(self, folder: Path) -> None:
        """Save section.json, verdict.json and the tables as LaTeX into `folder`."""
        folder.mkdir(parents=True, exist_ok=True)
        for table in [*self.tables, *([self.answer] if self.answer else [])]:
            (folder / f"{table.id}.tex").write_text(latex_table(table))
        plain = {"schema": SCHEMA, **_finite(asdict(self))}
        (folder / "verdict.json").write_text(json.dumps(plain["verdicts"], indent=1) + "\n")
        unfinished = folder / "section.json.unfinished"
        unfinished.write_text(json.dumps(plain, indent=1) + "\n")
        unfinished.rename(folder / "section.json")  # last: it marks the target as done


def _finite(value):
    """JSON knows no NaN: such numbers become null."""
    if isinstance(value, dict):
        return {key: _finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(one) for one in value]
    if hasattr(value, "item"):
        value = value.item()  # numpy's numbers
    return None if isinstance(value, float) and not math.isfinite(value) else value

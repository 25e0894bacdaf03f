"""The report of the experiments: one static page of HTML made from the targets' `section.json` files.

It opens from a file, without a server: what it shows beside text comes in scripts, which a page may load from a file
URL.

    index.html               text, verdicts and tables: readable without scripts
    page/data.js             plots, viewers, colours and runs, as one object
    page/images/HASH.js      the pixels of an image, loaded when it is looked at; HASH is of the EXR's content
    page/*.js, page/*.css    from experiments/page, and Plotly from its Python package
"""

import base64
import gzip
import hashlib
import itertools
import json
import math
import os
import re
import shlex
import shutil
import tomllib
from collections import Counter
from pathlib import Path
from urllib.parse import quote

import jinja2
import matplotlib
import numpy as np
import OpenEXR
import plotly
from markupsafe import Markup, escape

from lab.sections import HOLDS, SCHEMA

EXPERIMENTS = Path(__file__).resolve().parent.parent
SOURCES = EXPERIMENTS / "page"
PLOTLY = Path(plotly.__file__).parent / "package_data/plotly.min.js"
COLOUR_MAPS = {"error": "inferno", "difference": "berlin", "flip": "magma"}
LARGEST_HALF = float(np.finfo(np.float16).max)
LONGEST_SETTING = 200  # characters of JSON: longer settings of a run are left to its run.json
MANY_SERIES = 8
PIXELS_VERSION = b"1"  # of the format of page/images/HASH.js


class PageError(Exception):
    """A section that no page can be made of; the text says which and why."""


def build_page(folder: Path, sections: list[Path], machine: dict, output: Path | None = None) -> Path:
    """Make the page of the `section.json` files; returns its index.html.

    `folder` is the reproduction's folder, to which the images' paths are relative; the page goes there or to `output`.
    """
    output = output or folder
    page = output / "page"
    (page / "images").mkdir(parents=True, exist_ok=True)
    read = [_read_section(path, output) for path in sections]
    pixels = _Pixels(folder, page / "images")
    for section in read:
        for viewer in section["viewers"]:
            pixels.prepare(viewer, f"section '{section['name']}', viewer '{viewer['id']}'")
    pixels.remove_stale()

    data = {
        "methods": _methods(read),
        "plots": {plot["key"]: plot for section in read for plot in section["plots"]},
        "viewers": {viewer["key"]: viewer for section in read for viewer in section["viewers"]},
        "runs": {key: record for key in _run_keys(read) if (record := _run(folder / "runs" / key / "run.json"))},
        "colourMaps": {use: _colour_map(name) for use, name in COLOUR_MAPS.items()},
    }
    _write(page / "data.js", f"window.lampyris = {json.dumps(data, separators=(',', ':'))};\n")
    for source in [*SOURCES.glob("*.js"), *SOURCES.glob("*.css"), PLOTLY]:
        _copy(source, page / source.name)

    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(SOURCES), autoescape=True, trim_blocks=True)
    environment.filters["prose"] = prose
    environment.globals["significant"] = significant
    html = environment.get_template("index.html.jinja").render(
        groups=_groups(read),
        answers=[section for section in read if section.get("answer")],
        machine=machine,
        counts=Counter(verdict["holds"] for section in read for verdict in section["verdicts"]),
        holds=HOLDS,
        methods=set(data["methods"]),
    )
    index = output / "index.html"
    _write(index, html)
    return index


def prose(text: str) -> Markup:
    """Plain text as HTML: escaped, and `code` in backticks as such."""
    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))


def significant(value, digits: int = 3) -> str:
    """A value as text for a table: `digits` significant ones of a float, all of an integer, a dash for nothing."""
    if value is None or value == "":
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return ", ".join(significant(one, digits) for one in value)
    return _number(value, digits) if _is_number(value) else str(value)


def _number(value: float, digits: int) -> str:
    if isinstance(value, int) or value == 0:
        return _grouped(f"{value:,.0f}", abs(value))
    rounded = float(f"{value:.{digits - 1}e}")
    exponent = math.floor(math.log10(abs(rounded)))
    if -4 <= exponent < 6:
        return _grouped(f"{rounded:,.{max(0, digits - 1 - exponent)}f}", abs(rounded))
    return f"{rounded / 10.0**exponent:.{digits - 1}f}e{exponent}".replace("-", "−")


def _grouped(text: str, size: float) -> str:
    """Thousands apart from five digits on, by narrow spaces."""
    return text.replace(",", "\u202f" if size >= 10000 else "").replace("-", "−")


def _is_number(value) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _read_section(path: Path, output: Path) -> dict:
    section = json.loads(path.read_text())
    if section.get("schema") != SCHEMA:
        raise PageError(f"{path}: its schema is '{section.get('schema')}', not '{SCHEMA}'")
    section["anchor"] = _anchor(section["experiment"], section["name"])
    for kind in ("plots", "viewers"):
        for one in section[kind]:
            one["key"] = _anchor(section["anchor"], one["id"])
    linked = itertools.groupby(section["viewers"], lambda viewer: viewer["link"] or viewer["key"])
    section["viewer_rows"] = [list(row) for _, row in linked]
    _arrange(section["plots"])
    answer = section.get("answer")
    for table in [*section["tables"], *([answer] if answer else [])]:
        table["key"] = _anchor(section["anchor"], table["id"])
        latex = path.parent / f"{table['id']}.tex"
        table["latex"] = quote(os.path.relpath(latex, output)) if latex.exists() else ""
        for column in table["columns"]:
            values = [row[column["key"]] for row in table["rows"] if row.get(column["key"]) is not None]
            column["numeric"] = bool(values) and all(_is_number(value) for value in values)
    for one in section.get("figures", []):
        one["href"] = quote(os.path.relpath(path.parent / one["file"], output))
    for download in section["downloads"]:
        download["href"] = quote(os.path.relpath(path.parent / download["file"], output))
    return section


def _arrange(plots: list[dict]) -> None:
    """Plots stand in pairs where there is room; one with many series, or without a partner, has a row of its own."""
    alone = None
    for plot in plots:
        plot["wide"] = len(plot["series"]) > MANY_SERIES
        if alone and plot["wide"]:
            alone["wide"] = True
        alone = None if alone or plot["wide"] else plot
    if alone:
        alone["wide"] = True


def _anchor(*names: str) -> str:
    return "-".join(re.sub(r"[^A-Za-z0-9_]+", "-", name) for name in names)


def _groups(sections: list[dict]) -> list[dict]:
    """The sections by their experiment, in the order in which they come."""
    groups: dict[str, list[dict]] = {}
    for section in sections:
        groups.setdefault(section["experiment"], []).append(section)
    return [{"title": _title(name), "anchor": _anchor(name), "sections": of} for name, of in groups.items()]


def _title(experiment: str) -> str:
    """An experiment's title, or its folder's name made readable."""
    declared = EXPERIMENTS / experiment / "experiment.toml"
    title = tomllib.loads(declared.read_text()).get("title") if declared.exists() else None
    return title or experiment.replace("_", " ").capitalize()


def _methods(sections: list[dict]) -> list[str]:
    """Every method once, in order of appearance: its place picks its colour, everywhere on the page."""
    names: dict[str, None] = {}
    for section in sections:
        for plot in section["plots"]:
            names.update((series["method"], None) for series in plot["series"])
        for viewer in section["viewers"]:
            names.update((image["method"], None) for image in viewer["images"])
    names.pop("", None)
    names.pop("reference", None)  # it is drawn in the colour of text
    return list(names)


def _run_keys(sections: list[dict]) -> list[str]:
    keys: dict[str, None] = {}
    for section in sections:
        for verdict in section["verdicts"]:
            keys.update((key, None) for key in verdict["runs"])
        for plot in section["plots"]:
            keys.update((key, None) for series in plot["series"] for point in series["runs"] or [] for key in point)
        for viewer in section["viewers"]:
            keys.update((image["run"], None) for image in viewer["images"] if image["run"])
        for table in [*section["tables"], *([section["answer"]] if section.get("answer") else [])]:
            keys.update((key, None) for row in table["rows"] for key in row.get("runs") or [])
    return list(keys)


def _run(path: Path) -> dict | None:
    """What the page says of a run: its command and its settings, where its record is there."""
    if not path.is_file():
        return None
    record = json.loads(path.read_text())
    told = {}
    if record.get("command"):
        told["command"] = shlex.join(str(word) for word in record["command"])
    told["spec"] = {
        key: value
        for key, value in (record.get("spec") or {}).items()
        if value is not False and value not in (None, "", [], {}) and len(json.dumps(value)) <= LONGEST_SETTING
    }
    return told


def _colour_map(name: str) -> str:
    """256 colours of matplotlib, as base64 of RGB bytes."""
    colours = matplotlib.colormaps[name](np.linspace(0, 1, 256))[:, :3]
    return base64.b64encode(np.round(colours * 255).astype(np.uint8).tobytes()).decode()


class _Pixels:
    """Writes the scripts that hold images' pixels: only those whose EXR is new or changed."""

    def __init__(self, folder: Path, target: Path) -> None:
        self.folder = folder
        self.target = target
        self.used: dict[str, dict] = {}

    def prepare(self, viewer: dict, where: str) -> None:
        """Put into each image of a viewer where its pixels and those of its maps lie."""
        if not viewer["images"]:
            raise PageError(f"{where} has no image")
        names = [image["name"] for image in viewer["images"]]
        if viewer["reference"] and viewer["reference"] not in names:
            raise PageError(f"{where}: its reference '{viewer['reference']}' is none of its images: {', '.join(names)}")
        for image in viewer["images"]:
            for use, file in (("pixels", "file"), ("errorPixels", "error_map"), ("flipPixels", "flip_map")):
                image[use] = self._source(image[file], f"{where}, image '{image['name']}'") if image[file] else None
            if not image["pixels"]:
                raise PageError(f"{where}: the image '{image['name']}' names no file")

    def remove_stale(self) -> None:
        """Remove the scripts that no image uses any more."""
        kept = {f"{source['hash']}.js" for source in self.used.values()}
        for file in self.target.iterdir():
            if file.name not in kept:
                file.unlink()

    def _source(self, file: str, where: str) -> dict:
        """The hash of an EXR, and where its pixels lie in its picture of `fullWidth` by `fullHeight`."""
        if file in self.used:
            return self.used[file]
        path = self.folder / file
        if not path.is_file():
            raise PageError(f"{where}: there is no file {path}")
        hashed = hashlib.sha256(PIXELS_VERSION + path.read_bytes()).hexdigest()[:20]
        script = self.target / f"{hashed}.js"
        header = OpenEXR.File(str(path), header_only=True).header()
        (left, top), (right, bottom) = (corner.tolist() for corner in header["dataWindow"])
        (full_left, full_top), (full_right, full_bottom) = (corner.tolist() for corner in header["displayWindow"])
        if not script.exists():
            _write(script, _pixels_script(path, hashed))
        self.used[file] = {
            "hash": hashed,
            "x": left - full_left,
            "y": top - full_top,
            "width": right - left + 1,
            "height": bottom - top + 1,
            "fullWidth": full_right - full_left + 1,
            "fullHeight": full_bottom - full_top + 1,
        }
        return self.used[file]


def _pixels_script(path: Path, hashed: str) -> str:
    """A script that hands the pixels over: planes of little-endian halfs, R, G, B or Y alone, gzipped, in base64."""
    channels = OpenEXR.File(str(path), separate_channels=True).channels()
    names = ["R", "G", "B"] if "R" in channels else ["Y"]
    missing = [name for name in names if name not in channels]
    if missing:
        raise PageError(f"{path}: it has neither R, G, B nor Y, but {', '.join(channels)}")
    planes = np.stack([channels[name].pixels.astype(np.float32) for name in names])
    finite = np.isfinite(planes)
    halfs = np.where(finite, np.clip(planes, -LARGEST_HALF, LARGEST_HALF), planes).astype("<f2")
    packed = base64.b64encode(gzip.compress(halfs.tobytes(), mtime=0)).decode()
    _, height, width = halfs.shape
    told = {"width": width, "height": height, "channels": len(names), "data": packed}
    return f'lampyrisImage("{hashed}", {json.dumps(told)});\n'


def _write(path: Path, text: str) -> None:
    """Write beside the place and rename: a page that is open never sees half a file."""
    unfinished = path.with_name(path.name + ".unfinished")
    unfinished.write_text(text, encoding="utf-8")
    unfinished.rename(path)


def _copy(source: Path, target: Path) -> None:
    new, old = source.stat(), target.stat() if target.exists() else None
    if not old or new.st_mtime > old.st_mtime or new.st_size != old.st_size:
        shutil.copyfile(source, target)

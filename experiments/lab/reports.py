"""What reports of several experiments share: verdicts from criteria, data, references in words, pictures."""

import csv
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from lab.catalogue import Scene
from lab.images import encode, exposure_of, reference_error
from lab.sections import Download
from lab.store import Store


def judge(passed: Iterable[bool]) -> str:
    """What a verdict says when these criteria were looked at: all hold, some, none, or there was nothing to look at."""
    passed = list(passed)
    if not passed:
        return "not tested"
    return "yes" if all(passed) else "partly" if any(passed) else "no"


def what_failed(record: dict) -> str:
    """The last line of why a run could not be made, or an empty string."""
    return (record.get("failed", "").strip().splitlines() or [""])[-1]


def write_csv(path: Path, rows: list[dict]) -> Download:
    """The data of a figure; the columns are the keys of the rows, lists of run keys joined by spaces."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        for row in rows:
            writer.writerow({key: " ".join(value) if isinstance(value, list) else value for key, value in row.items()})
    return Download(path.name, f"{path.stem.replace('_', ' ')} (CSV)")


def reference_text(scene: Scene, store: Store) -> str:
    """By whom a scene's reference is, and how wrong it is itself."""
    reference = scene.reference
    told = reference_error(reference, store)
    error = "its own relMSE is not known"
    if told["relmse"] is not None:
        error = f"its own relMSE is {told['relmse']:.2g} ({told['how']})"
    dependent = "" if reference.independent else "; it is not independent of the methods that map photons"
    return f"The reference of “{scene.title}” is by {reference.by}; {error}{dependent}."


def show_picture(axes, image: np.ndarray, title: str, exposure: float | None = None) -> None:
    """An image of scene-linear light on matplotlib's axes, without a frame."""
    axes.imshow(encode(image, exposure_of(image) if exposure is None else exposure), interpolation="nearest")
    axes.set_title(title, fontsize=7)
    axes.set_axis_off()

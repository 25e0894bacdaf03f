"""A target: what one figure of an experiment needs, and the plan that its module reads.

An experiment is a folder with an `experiment.toml`, which has a title and a table [targets.NAME] for each target, and
a module NAME.py with

    def runs(plan: Plan) -> list[Run]                      # what to render or measure: no side effects
    def report(plan: Plan, store: Store, folder: Path) -> Section   # reads records; writes figures and data into folder

The table has at least title, scenes, methods, backends; what stands in its table `full` takes their place with --full.
"""

import importlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from lab.catalogue import EXPERIMENTS, Catalogue, DeclarationError, Method, Scene, read_toml
from lab.runs import Run


@dataclass
class Plan:
    """A target's declaration at the size that was asked for."""

    experiment: str
    name: str
    table: dict
    catalogue: Catalogue
    available_backends: list[str]
    device: str
    full: bool

    def __getitem__(self, key: str):
        if key not in self.table:
            raise DeclarationError(
                f"experiments/{self.experiment}/experiment.toml: [targets.{self.name}] lacks '{key}'"
            )
        return self.table[key]

    def get(self, key: str, default=None):
        """A value of the target's table, or the default."""
        return self.table.get(key, default)

    @cached_property
    def scenes(self) -> list[Scene]:
        """The scenes that it names."""
        return [self.catalogue.scene(name) for name in self["scenes"]]

    @cached_property
    def methods(self) -> list[Method]:
        """The methods that it names."""
        return self.catalogue.methods(self["methods"])

    @property
    def backends(self) -> list[str]:
        """Of the backends that it names, those that were asked for."""
        return [one for one in self["backends"] if one in self.available_backends]

    def run(self, scene: Scene, method: Method | None, backend: str, **changes) -> Run:
        """A run of a scene with a method on a backend; the budget is among `changes`."""
        run = scene.run(**{"backend": backend, "device": self.device if backend == "vulkan" else "", **changes})
        return method.apply(run, scene) if method else run


@dataclass
class Target:
    """A target by its name, `experiment/name`."""

    experiment: str
    name: str
    table: dict

    @property
    def id(self) -> str:
        """EXPERIMENT/NAME."""
        return f"{self.experiment}/{self.name}"

    def plan(self, catalogue: Catalogue, backends: list[str], device: str, full: bool, changes: dict) -> Plan:
        """What its module reads; `changes` take the place of what the declaration says."""
        table = {key: value for key, value in self.table.items() if key != "full"}
        if full:
            table.update(self.table.get("full", {}))
        table.update(changes)
        return Plan(self.experiment, self.name, table, catalogue, backends, device, full)

    def module(self):
        """Its Python module; experiments/ is on the path."""
        return importlib.import_module(f"{self.experiment}.{self.name}")


def all_targets(folder: Path = EXPERIMENTS) -> list[Target]:
    """Every target of every experiment, in the order of their declarations."""
    found = []
    for file in sorted(folder.glob("*/experiment.toml"), key=lambda path: read_toml(path).get("order", 99)):
        table = read_toml(file)
        found += [Target(file.parent.name, name, one) for name, one in table["targets"].items()]
    return found


def with_references(runs: list[Run]) -> list[Run]:
    """The runs, each after the run that renders its reference; none twice."""
    ordered: dict[Run, None] = {}
    for run in runs:
        if isinstance(run.reference, Run):
            for needed in with_references([run.reference]):
                ordered.setdefault(needed)
        ordered.setdefault(run)
    return list(ordered)

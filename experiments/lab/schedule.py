"""From targets to a plan that Snakemake carries out: `plan.json` names each run, what it needs, and targets' runs.

The jobs call this module: `python -m lab.schedule run PLAN KEY`, `... section PLAN TARGET`, `... page PLAN`.
"""

import hashlib
import json
import sys
import traceback
from dataclasses import dataclass, field
from pathlib import Path

from lab.catalogue import EXPERIMENTS, Catalogue, read_toml
from lab.runs import Machine, from_plain, to_plain
from lab.store import RunFailedError, Store
from lab.target import Plan, Target, all_targets, with_references

PLAN = "plan.json"
CODE = "code.json"


@dataclass
class Reproduction:
    """Where a reproduction lies, and what it was asked for; saved as part of the plan."""

    folder: Path
    machine: Machine
    methods: Path
    scenes: Path
    backends: list[str]
    full: bool
    changes: dict[str, dict] = field(default_factory=dict)  # of targets' tables, by the targets' names

    @property
    def store(self) -> Store:
        """Its results."""
        return Store(self.folder, self.machine)

    def plan(self, target: Target) -> Plan:
        """The declaration of a target, at the size that was asked for."""
        catalogue = Catalogue.read(self.methods, self.scenes, self.full)
        return target.plan(catalogue, self.backends, self.machine.device, self.full, self.changes.get(target.name, {}))

    def plain(self) -> dict:
        """As JSON has it."""
        texts = {"folder": self.folder, "methods": self.methods, "scenes": self.scenes}
        rest = {"backends": self.backends, "full": self.full, "changes": self.changes}
        rest["machine"] = self.machine.plain()
        return {**{key: str(value) for key, value in texts.items()}, **rest}

    @staticmethod
    def from_plain(plain: dict) -> "Reproduction":
        """The reproduction that `plain` wrote."""
        paths = {key: Path(plain[key]) for key in ("folder", "methods", "scenes")}
        return Reproduction(**{**plain, **paths, "machine": Machine.from_plain(plain["machine"])})


def write_plan(reproduction: Reproduction, targets: list[Target]) -> dict:
    """Ask every target for its runs; returns the plan, which is also saved."""
    runs: dict[str, dict] = {}
    of_targets = {}
    store = reproduction.store
    for target in targets:
        keys = []
        for run in with_references(target.module().runs(reproduction.plan(target))):
            key = store.key(run)
            needs = [store.key(run.reference)] if hasattr(run.reference, "kind") else []
            runs[key] = {"spec": to_plain(run), "needs": needs}
            keys.append(key)
        of_targets[target.id] = keys
    plan = {"reproduction": reproduction.plain(), "runs": runs, "targets": of_targets}
    write_if_changed(reproduction.folder / PLAN, json.dumps(plan, indent=1) + "\n")
    write_if_changed(reproduction.folder / CODE, json.dumps(_code(reproduction), indent=1) + "\n")
    return plan


def _code(reproduction: Reproduction) -> dict:
    """Hashes of what makes sections and pages: where it changes, those are made again of the same results."""
    files = [*EXPERIMENTS.rglob("*.py"), *EXPERIMENTS.glob("*/experiment.toml"), *(EXPERIMENTS / "page").glob("*.*")]
    files += [reproduction.methods, reproduction.scenes]
    return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(set(files))}


def write_if_changed(path: Path, text: str) -> None:
    """What did not change keeps its date, so that nothing is made again for it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def section_folder(folder: Path, target: str) -> Path:
    """Where a target leaves its section, figures and data."""
    return folder / "targets" / target


def make_run(reproduction: Reproduction, plan: dict, key: str) -> None:
    """Make the run of a key."""
    run = from_plain(plan["runs"][key]["spec"])
    store = reproduction.store
    if store.key(run) != key:
        raise RunFailedError(
            f"run {key} is not what was planned any more: a scene, the program or a plugin has changed since"
        )
    record = store.make(run)
    done = sum(store.place(one).exists() for one in plan["runs"])
    told = record.get("failed", "").splitlines()[-1:] or [f"{record['seconds']:.1f} s"]
    print(f"{done}/{len(plan['runs'])} {' '.join(record['command'])}: {told[0]}", flush=True)


def make_section(reproduction: Reproduction, name: str) -> None:
    """Make a target's section of its runs' results."""
    target = next(one for one in all_targets() if one.id == name)
    folder = section_folder(reproduction.folder, name)
    folder.mkdir(parents=True, exist_ok=True)
    target.module().report(reproduction.plan(target), reproduction.store, folder).write(folder)


def make_page(reproduction: Reproduction, plan: dict) -> None:
    """Make the page and results.md of all sections."""
    # Here, since every run starts this module, and most of its time went into importing what draws the page.
    from lab.machine import describe_machine  # noqa: PLC0415
    from lab.page import build_page  # noqa: PLC0415
    from lab.results import write_results  # noqa: PLC0415

    sections = [section_folder(reproduction.folder, target) / "section.json" for target in plan["targets"]]
    machine = describe_machine(reproduction.machine)
    titles = {file.parent.name: read_toml(file)["title"] for file in EXPERIMENTS.glob("*/experiment.toml")}
    write_results(reproduction.folder, sections, machine, titles)
    build_page(reproduction.folder, sections, machine)


def main(words: list[str]) -> int:
    """Do one job of the plan; what went wrong is said in full, for the job's log."""
    job, path, *rest = words
    plan = json.loads(Path(path).read_text())
    reproduction = Reproduction.from_plain(plan["reproduction"])
    try:
        if job == "run":
            make_run(reproduction, plan, rest[0])
        elif job == "section":
            make_section(reproduction, rest[0])
        else:
            make_page(reproduction, plan)
    except RunFailedError as error:
        print(error, file=sys.stderr)
        return 1
    except Exception:
        traceback.print_exc()
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""Run the experiments: ./dev reproduce [TARGET...] [--full].

Makes every run that is missing, one at a time, then figures, data and verdicts of each target, and a page to look
at. What is there is used again; a run that was cut short or damaged is made again. TARGET is a target's name, or an
experiment's for all of its targets.
"""

import argparse
import fcntl
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lab.catalogue import EXPERIMENTS, DeclarationError
from lab.results import publish
from lab.runs import ROOT, Machine
from lab.schedule import PLAN, Reproduction, write_plan
from lab.target import Target, all_targets

BACKENDS = ["cpu", "vulkan"]


class Parser(argparse.ArgumentParser):
    """Wrong arguments are told in a line, and end the program with 1, as in the other commands."""

    def error(self, message: str) -> None:
        raise DeclarationError(f"{message}; --help lists what there is")


def arguments_of(words: list[str]) -> argparse.Namespace:
    """The command line."""
    parser = Parser(prog="./dev reproduce", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("targets", nargs="*", metavar="TARGET", help="what to reproduce; all that there is, if none is named")
    add("--full", action="store_true", help="the paper's sizes: hours")
    add("--list", action="store_true", help="list the targets")
    add("--device", default="", metavar="N|NAME", help="Vulkan device of every Vulkan run")
    add("--backends", default=",".join(BACKENDS), help="of cpu,vulkan: those to run on")
    add("--methods", type=Path, default=EXPERIMENTS / "methods.toml", help="the methods that are compared")
    add("--scenes", type=Path, default=EXPERIMENTS / "scenes.toml", help="the scenes")
    add("--folder", type=Path, help="where results go: build/reproduce, or build/reproduce-full")
    add("--program", type=Path, default=ROOT / "build/release/lampyris", help="the program")
    add("--set", action="append", default=[], metavar="TARGET.KEY=VALUE", help="change a target's declaration (TOML)")
    add("--publish", action="store_true", help="write docs/results.md, and the runs behind its numbers")
    add("--executor", default="local", help="Snakemake's: local, or slurm on a cluster")
    add("--jobs", type=int, default=1, metavar="N", help="runs at a time on a cluster, each on its own machine")
    add("--cores", type=int, default=os.cpu_count(), help="cores of a machine: a run takes them all")
    return parser.parse_args(words)


def chosen_targets(names: list[str]) -> list[Target]:
    """Targets by their names, or their experiments'."""
    known = all_targets()
    for name in names:
        if not any(name in {one.id, one.name, one.experiment} for one in known):
            raise DeclarationError(f"no target is called '{name}'; there are: {', '.join(one.name for one in known)}")
    return [one for one in known if not names or {one.id, one.name, one.experiment} & set(names)]


def wanted_backends(text: str) -> list[str]:
    """The backends that --backends names."""
    wanted = text.split(",")
    if unknown := set(wanted) - set(BACKENDS):
        raise DeclarationError(f"--backends: '{', '.join(sorted(unknown))}'; there are: {', '.join(BACKENDS)}")
    return wanted


def changes_of(words: list[str]) -> dict[str, dict]:
    """What --set asks for, by target; a value that is no TOML is text."""
    known = {one.name: one.table for one in all_targets()}
    changes: dict[str, dict] = {}
    for word in words:
        match = re.fullmatch(r"(\w+)\.(\w+)=(.*)", word, flags=re.DOTALL)
        if not match or match[1] not in known:
            raise DeclarationError(f"--set {word}: expected TARGET.KEY=VALUE; targets: {', '.join(sorted(known))}")
        target, key, text = match.groups()
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            value = text
        # Of targets that take over another's table (`runs_of`), keys of that one.
        declared = {**known.get(known[target].get("runs_of"), {}), **known[target]}
        if key not in declared:
            raise DeclarationError(f"--set {word}: {target} has no '{key}'; it has: {', '.join(sorted(declared))}")
        number = isinstance(value, int | float) and isinstance(declared[key], int | float)
        if not number and not isinstance(value, type(declared[key])):
            raise DeclarationError(f"--set {word}: expected a value such as {json.dumps(declared[key])}")
        changes.setdefault(target, {})[key] = value
    return changes


def carry_out(folder: Path, arguments: argparse.Namespace) -> int:
    """Hand the plan to Snakemake; its own state lies in the folder, too."""
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(EXPERIMENTS / "Snakefile")]
    command += ["--directory", str(folder), "--config", f"plan={folder / PLAN}", f"cores={arguments.cores}"]
    local = ["--cores", str(arguments.cores)]
    command += ["--executor", arguments.executor]
    command += local if arguments.executor == "local" else ["--jobs", str(arguments.jobs)]
    # Our own lock is held, and a killed run leaves no half results: Snakemake's marks of both would only be in the way.
    shutil.rmtree(folder / ".snakemake/incomplete", ignore_errors=True)
    command += ["--nolock", "--rerun-triggers", "mtime", "--keep-incomplete", "--drop-metadata", "--keep-going"]
    command += ["--quiet", "all"]
    environment = os.environ | {"PYTHONPATH": str(EXPERIMENTS), "MPLBACKEND": "Agg"}
    return subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, check=False).returncode


def reproduction_of(arguments: argparse.Namespace) -> Reproduction:
    """What was asked for; a machine that lacks what it needs is told before anything starts."""
    name = "build/reproduce-full" if arguments.full else "build/reproduce"
    for file in (arguments.program, arguments.methods, arguments.scenes):
        if not file.is_file():
            raise DeclarationError(f"{file} does not exist")
    made = Reproduction(
        (arguments.folder or ROOT / name).resolve(),
        Machine.ask(arguments.program, arguments.device),
        arguments.methods.resolve(),
        arguments.scenes.resolve(),
        wanted_backends(arguments.backends),
        arguments.full,
        changes_of(arguments.set),
    )
    if "vulkan" in made.backends and not made.machine.vulkan:
        which = f" matches '{arguments.device}'" if arguments.device else ""
        raise DeclarationError(f"no Vulkan device{which}; `lampyris devices` lists them, --backends cpu needs none")
    return made


def reproduce(arguments: argparse.Namespace) -> int:
    """Plan, check what is there, carry out, and say where to look."""
    targets = chosen_targets(arguments.targets)
    if arguments.list:
        for target in targets:
            print(f"{target.name:18} {target.table['title']}  ({target.experiment})")
        return 0
    reproduction = reproduction_of(arguments)
    folder = reproduction.folder
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise DeclarationError(f"another reproduction runs in {folder}") from None
        plan = write_plan(reproduction, targets)
        for told in reproduction.store.remove_damaged(plan["runs"]):
            print(told, file=sys.stderr)
        shutil.rmtree(folder / "unfinished", ignore_errors=True)
        missing = [key for key in plan["runs"] if not reproduction.store.place(key).exists()]
        print(f"{len(targets)} targets, {len(plan['runs'])} runs, {len(missing)} of them still to do", flush=True)
        status = carry_out(folder, arguments)
        if status:
            print("error: some runs could not be done; the messages above say which and why", file=sys.stderr)
            return 2
    records = [json.loads((folder / "runs" / key / "run.json").read_text()) for key in plan["runs"]]
    failed = [one for one in records if "failed" in one]
    if failed:
        print(f"the machine could not do {len(failed)} runs; the page lists them")
    if arguments.publish:
        publish(folder)
    print(folder / "index.html")
    return 0


def main() -> int:
    """Errors of declarations and arguments are told in a line."""
    try:
        return reproduce(arguments_of(sys.argv[1:]))
    except DeclarationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())

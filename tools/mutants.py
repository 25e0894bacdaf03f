#!/usr/bin/env python3
"""Put small faults into a copy of the code, one at a time, and see whether the tests find them.

Usage: build/venv/bin/python tools/mutants.py [NAME]... [--list] [--alone] [--jobs N] [--folder FOLDER]

tests/mutants/mutants.toml has the faults, which are called mutants, and the tests that should find each. Tests that
take minutes (`long`) are left out. By default one build has all mutants, and an environment variable switches one on:
    `old` becomes (mutant == 7 ? (new) : (old)), or if (mutant == 7) { new } else { old }
With --alone, each mutant has its own build: its text replaces the old one and nothing else differs. That takes minutes
for a mutant in a kernel. Either way its tests must pass without it first. Backends are the CPU's alone: a mutant in a
kernel is the same on all of them, so that they cannot find it by disagreeing.

Exit code: 0 if tests find every mutant, 1 if not, 2 if the mutants cannot be tried.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parent.parent
LIST = ROOT / "tests/mutants/mutants.toml"
VARIABLE = "LAMPYRIS_MUTANT"
SWITCH = f"""// Included in every file: which mutant is on (tools/mutants.py).
#pragma once
#include <cstdlib>
inline const int lampyris_mutant = [] {{
    const char* number = std::getenv("{VARIABLE}");
    return number ? std::atoi(number) : 0;
}}();
"""
SETTINGS = {
    "CMAKE_BUILD_TYPE": "Release",
    "CMAKE_CXX_FLAGS_RELEASE": "-O1 -DNDEBUG",
    "LAMPYRIS_VULKAN": "OFF",
    "LAMPYRIS_SPECIALISED_KERNELS": "OFF",
    "LAMPYRIS_WERROR": "OFF",
}
MOST_SECONDS = 600  # of a test


class Failure(Exception):
    """What ends the program with exit code 2."""


@dataclass
class Mutant:
    number: int  # from 1, in the order of the file
    name: str
    file: str
    fault: str
    old: str
    new: str
    ctest: str = ""
    pytest: tuple[str, ...] = ()

    def replacement(self, switched: bool) -> str:
        """The text in place of `old`."""
        if not switched:
            return self.new
        on = f"lampyris_mutant == {self.number}"
        if self.old.endswith(";"):
            return f"if ({on}) {{ {self.new} }} else {{ {self.old} }}"
        return f"({on} ? ({self.new}) : ({self.old}))"

    def targets(self) -> set[str]:
        """What its tests need of the build."""
        tests = set(re.findall(r"\w+_test\b", self.ctest))
        return tests | ({"lampyris_program", "lampyris_formats"} if self.pytest else set())


def read_list() -> list[Mutant]:
    entries = tomllib.loads(LIST.read_text())["mutant"]
    mutants = []
    for number, entry in enumerate(entries, 1):
        texts = {key: entry[key].strip() for key in ("name", "file", "fault", "old", "new")}
        mutants.append(Mutant(number, **texts, ctest=entry.get("ctest", ""), pytest=tuple(entry.get("pytest", ()))))
    return mutants


def mutated(file: str, mutants: list[Mutant], switched: bool) -> bytes:
    """The file with those of the mutants that are of it."""
    text = (ROOT / file).read_text()
    places = []
    for mutant in mutants:
        if mutant.file != file:
            continue
        if text.count(mutant.old) != 1:
            raise Failure(f"{mutant.name}: its old text is {text.count(mutant.old)} times in {file}, and must be once")
        places.append((text.index(mutant.old), mutant))
    for place, mutant in sorted(places, key=lambda item: item[0], reverse=True):
        text = text[:place] + mutant.replacement(switched) + text[place + len(mutant.old) :]
    return text.encode()


class Copy:
    """A copy of the tree with a build of its own."""

    def __init__(self, folder: Path, left_out: list[str], jobs: int):
        self.folder = folder
        self.tree, self.build = folder / "tree", folder / "build"
        self.left_out, self.jobs = left_out, jobs

    def write(self, mutants: list[Mutant], switched: bool) -> None:
        """Makes the copy that of the present tree with some mutants. Files that are the same keep their time."""
        listed = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=ROOT,
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        files = {file for file in listed.split("\0") if file and (ROOT / file).is_file()}
        files = {file for file in files if not any(file.startswith(folder + "/") for folder in self.left_out)}
        changed = {mutant.file for mutant in mutants}
        for file in sorted(files):
            to = self.tree / file
            content = mutated(file, mutants, switched) if file in changed else (ROOT / file).read_bytes()
            if to.is_file() and to.read_bytes() == content:
                continue
            to.parent.mkdir(parents=True, exist_ok=True)
            to.write_bytes(content)
            shutil.copymode(ROOT / file, to)
        for path in list(self.tree.rglob("*")):
            if path.is_file() and path.suffix != ".pyc" and str(path.relative_to(self.tree)) not in files:
                path.unlink()
        switch = self.folder / "switch.h"
        if not switch.is_file() or switch.read_text() != SWITCH:
            switch.write_text(SWITCH)

    def environment(self, number: int = 0) -> dict[str, str]:
        return {
            **os.environ,
            "CCACHE_BASEDIR": str(self.tree),
            "CCACHE_NOHASHDIR": "1",
            "LAMPYRIS_BUILD_DIR": str(self.build),
            VARIABLE: str(number),
        }

    def make(self, targets: set[str], log: str) -> bool:
        """Whether the targets could be built; what the compiler says is in the file `log` of the folder."""
        settings = [f"-D{name}={value}" for name, value in SETTINGS.items()]
        settings.append(f"-DCMAKE_CXX_FLAGS=-include {self.folder / 'switch.h'}")
        steps = [
            ["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja", *settings],
            ["cmake", "--build", self.build, "-j", str(self.jobs), "--target", *sorted(targets)],
        ]
        with (self.folder / log).open("w") as file:
            for step in steps:
                if subprocess.run(step, env=self.environment(), stdout=file, stderr=file, check=False).returncode != 0:
                    return False
        return True

    def failures(self, mutant: Mutant, number: int) -> list[str]:
        """Those of the mutant's tests that fail, up to the first; more if they run at the same time."""
        report = self.folder / "report.xml"
        found: list[str] = []
        if mutant.ctest:
            command = ["ctest", "--test-dir", self.build, "-R", mutant.ctest, "-LE", "^long$", "-j", str(self.jobs)]
            command += ["--timeout", str(MOST_SECONDS), "--output-junit", report, "--no-tests=error"]
            found += self.failed([*command, "--stop-on-failure"], report, number)
        if mutant.pytest and not found:
            command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-m", "not long"]
            command += [f"--junitxml={report}", *(self.tree / "tests" / file for file in mutant.pytest)]
            found += self.failed(command, report, number)
        return found

    def failed(self, command: list, report: Path, number: int) -> list[str]:
        report.unlink(missing_ok=True)
        done = subprocess.run(
            command, cwd=self.tree, env=self.environment(number), capture_output=True, text=True, check=False
        )
        if not report.is_file():
            raise Failure(f"no test ran:\n{done.stdout}{done.stderr}")
        found = []
        for case in ElementTree.parse(report).iter("testcase"):
            if case.get("status") == "fail" or case.find("failure") is not None or case.find("error") is not None:
                found.append(case.get("name", "?").split("  # GetParam")[0])
        if done.returncode != 0 and not found:
            raise Failure(f"no test ran, or they could not be told apart:\n{done.stdout}{done.stderr}")
        return found


def row(name: str, file: str, result: str, seconds: str, tests: str) -> None:
    print(f"{name:<34} {file:<48} {result:<15} {seconds:>6}  {tests}", flush=True)


def try_out(copy: Copy, mutant: Mutant, alone: bool, known: dict) -> bool:
    """Prints the mutant's row; whether it was found. `known`: which tests fail without mutants."""
    start = time.monotonic()
    tests = (mutant.ctest, mutant.pytest)
    if tests not in known:
        known[tests] = copy.failures(mutant, 0)
    failures = known[tests]
    result = "fails without"
    if not failures:
        if alone:
            copy.write([mutant], switched=False)
        result = "does not build"
        if not alone or copy.make(mutant.targets(), f"{mutant.name}.log"):
            failures = copy.failures(mutant, mutant.number)
            result = "found" if failures else "NOT FOUND"
        if alone:
            copy.write([], switched=False)
            copy.make(mutant.targets(), "build.log")
    row(mutant.name, mutant.file, result, f"{time.monotonic() - start:.0f}", ", ".join(failures))
    return result == "found"


def run(options: argparse.Namespace, mutants: list[Mutant]) -> int:
    unknown = set(options.names) - {mutant.name for mutant in mutants}
    if unknown:
        raise Failure(f"no mutant is called {', '.join(sorted(unknown))}; --list names them")
    chosen = [mutant for mutant in mutants if not options.names or mutant.name in options.names]
    if options.list:
        for mutant in chosen:
            print(f"{mutant.name:<34} {mutant.file:<48} {mutant.fault}")
        return 0
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    copy = Copy(folder, tomllib.loads(LIST.read_text()).get("leave_out", []), options.jobs)
    copy.write([] if options.alone else mutants, switched=not options.alone)
    targets = set().union(*(mutant.targets() for mutant in chosen))
    if not copy.make(targets, "build.log"):
        raise Failure(f"the build failed: {folder / 'build.log'} tells why")
    row("mutant", "file", "result", "s", "tests that fail")
    known: dict = {}
    found = sum(try_out(copy, mutant, options.alone, known) for mutant in chosen)
    print(f"{found} of {len(chosen)} mutants are found")
    return 0 if found == len(chosen) else 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="mutants; all without")
    parser.add_argument("--list", action="store_true", help="say what there is, and run nothing")
    parser.add_argument("--alone", action="store_true", help="one build for each mutant")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes at a time")
    parser.add_argument("--folder", type=Path, default=ROOT / "build/mutants", help="for the copy and its build")
    try:
        return run(parser.parse_args(), read_list())
    except Failure as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())

"""Results under their keys: `runs/KEY/run.json` (schema `lampyris.run/1`) and the image that was rendered.

A result is written beside its place and renamed into it, so that it is there whole or not at all; each carries the
hash of its own text and of its files, so that a damaged one is found.
"""

import contextlib
import hashlib
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from lab.runs import ROOT, Machine, Run, file_hash, inputs_of, key_of, to_plain

SCHEMA = "lampyris.run/1"
IMAGE = "image.exr"


class RunFailedError(Exception):
    """The program refused the scene or the arguments, or died: the declaration is wrong, or the program is."""


class DeviceError(RunFailedError):
    """The machine cannot (exit code 2): too little memory, no such device. That is a result, and kept as `failed`."""


def _digest(record: dict) -> str:
    return hashlib.sha256(
        json.dumps({k: v for k, v in record.items() if k != "digest"}, sort_keys=True).encode()
    ).hexdigest()


def _shown(path: Path) -> str:
    """A path as a reader would type it in the project's folder."""
    return os.path.relpath(path, ROOT)


@dataclass
class Store:
    """The results of runs, in `folder`/runs."""

    folder: Path
    machine: Machine

    def place(self, key: str) -> Path:
        """The folder of a key's result."""
        return self.folder / "runs" / key

    def key(self, run: Run) -> str:
        """The key of a run on this machine."""
        return key_of(run, self.machine)

    def record(self, run: Run) -> dict:
        """The result of a run that was made."""
        return json.loads((self.place(self.key(run)) / "run.json").read_text())

    def image(self, run: Run) -> Path:
        """The image of a run that was made."""
        return self.place(self.key(run)) / IMAGE

    def damage(self, key: str) -> str:
        """What is wrong with a result that lies in its place, or an empty string."""
        place = self.place(key)
        try:
            record = json.loads((place / "run.json").read_text())
            if record["key"] != key or record["digest"] != _digest(record):
                return "run.json is not what was written"
            for name, hashed in record["files"].items():
                if hashlib.sha256((place / name).read_bytes()).hexdigest() != hashed:
                    return f"{name} is not what was written"
        except (OSError, ValueError, KeyError, TypeError) as error:
            return f"{type(error).__name__}: {error}"
        return ""

    def remove_damaged(self, keys: Iterable[str]) -> list[str]:
        """Remove results that are not what was written, so that they are made again; returns a line for each."""
        told = []
        for key in keys:
            place = self.place(key)
            if not place.exists():
                continue
            wrong = self.damage(key)
            if wrong:
                shutil.rmtree(place)
                told.append(f"{_shown(place)}: {wrong}; it is made again")
        return told

    def make(self, run: Run) -> dict:
        """Make a run, whatever there is, and keep its result."""
        key = self.key(run)
        place = self.place(key)
        unfinished = self.folder / "unfinished" / key
        shutil.rmtree(unfinished, ignore_errors=True)
        unfinished.mkdir(parents=True)
        reference = self._reference(run)
        program = _shown(self.machine.program)
        if run.measures_time and run.backend == "vulkan" and run.kind == "render":
            with contextlib.suppress(DeviceError):
                self._warm_up(run, unfinished)
        statistics, image = unfinished / "statistics.json", unfinished / IMAGE
        started = time.time()
        command = run.command(program, _shown(image), _shown(statistics), reference)
        try:
            output = _call(command, run)
            failed = ""
        except DeviceError as error:
            output, failed = "", str(error)
        record = {
            "schema": SCHEMA,
            "key": key,
            "spec": to_plain(run),
            "inputs": inputs_of(run, self.machine),
            # Shown to readers, who render into their own folder.
            "command": run.command(program, "image.exr", "statistics.json", reference),
            "started": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(started)),
            "seconds": round(time.time() - started, 3),
            "load": os.getloadavg()[0],
            "version": self.machine.version,
            "processor": self.machine.processor,
            "files": {},
        }
        if failed:
            record["failed"] = failed
        elif run.kind == "bench":
            record["bench"] = json.loads(output)
        else:
            record["statistics"] = json.loads(statistics.read_text())
            record["files"][IMAGE] = file_hash.__wrapped__(image)
            if reference:
                told = _call([program, "compare", _shown(image), reference, "--json"], run)
                record["compare"] = json.loads(told)
            statistics.unlink()
        record["digest"] = _digest(record)
        (unfinished / "run.json").write_text(json.dumps(record, indent=1) + "\n")
        shutil.rmtree(place, ignore_errors=True)
        place.parent.mkdir(parents=True, exist_ok=True)
        unfinished.rename(place)
        return record

    def _reference(self, run: Run) -> str:
        if isinstance(run.reference, Run):
            return _shown(self.image(run.reference))
        return run.reference or ""

    def _warm_up(self, run: Run, folder: Path) -> None:
        """Shaders are compiled at their first dispatch, and kept by the driver: let that happen before it counts."""
        short = run.but(passes=1, spp=None, time_s=None) if not run.spp else run.but(spp=1, passes=1, time_s=None)
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            image, statistics = Path(scratch) / IMAGE, Path(scratch) / "statistics.json"
            _call(short.command(_shown(self.machine.program), _shown(image), _shown(statistics)), run)


def _call(command: list[str], run: Run) -> str:
    """Run a program in the project's folder to its end; returns its output. It does not outlive an interruption."""
    child = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        output, errors = child.communicate()
    except BaseException:
        child.send_signal(signal.SIGTERM)
        child.wait()
        raise
    bench_gave_up = (
        run.kind == "bench" and child.returncode == 2 and output.strip()
    )  # a structure did not fit: it says so
    if child.returncode != 0 and not bench_gave_up:
        kind = DeviceError if child.returncode == 2 else RunFailedError
        raise kind(f"{' '.join(command)}\nended with {child.returncode}:\n{errors.strip() or output.strip()}")
    return output

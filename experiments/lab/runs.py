"""A run: everything that its result depends on, as plain data, and the key that is made of all of it.

The key is a hash of the specification, of the content (whatever the dates) of the scene's files, the program, plugins
and reference, and of the device. The same key, the same run: results are kept under it and used again.
"""

import hashlib
import json
import platform
import re
import subprocess
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEY_DIGITS = 20
# What a scene may pull in, by the suffix of the quoted name; anything else in its text is text.
_FILE_NAME = re.compile(
    rb'"([^"\n]+\.(?:pbrt|ply|ply\.gz|png|jpg|jpeg|exr|pfm|hdr|tga|tif|tiff|spd|bmp|gif))"', re.IGNORECASE
)


@dataclass(frozen=True)
class Run:
    """One call of the program; what is None or empty is left to its defaults.

    `kind` is "render" or "bench" (`lampyris bench photon-maps`). `scene` is relative to the project. One of `passes`,
    `spp`, `time_s` is the budget; `eye_samples` are those of an integrator that fixes them (`ppm`). `reference` is
    another run, whose image it is, or an EXR's path. `measures_time` runs are warmed up first. `repeat` tells apart
    runs that differ in nothing but when they were made.
    """

    scene: str = ""
    integrator: str = ""
    photon_map: str = ""
    backend: str = "cpu"
    device: str = ""
    threads: int | None = None
    seed: int = 1
    resolution: str = ""
    crop: str = ""
    passes: int | None = None
    spp: int | None = None
    eye_samples: int | None = None
    time_s: float | None = None
    settings: tuple[str, ...] = ()
    plugins: tuple[str, ...] = ()
    skip_unsupported: bool = False
    reference: "Run | str | None" = None
    measures_time: bool = False
    repeat: int = 0
    kind: str = "render"
    arguments: tuple[str, ...] = ()  # of a bench, after its name

    def __post_init__(self) -> None:
        if self.kind == "render" and not (self.passes or self.spp or self.time_s):
            raise ValueError(f"a run of {self.scene} has no budget: give passes, spp or time_s")

    def but(self, **changes) -> "Run":
        """The same run with something else."""
        return replace(self, **changes)

    def command(self, program: str, image: str, statistics: str, reference: str = "") -> list[str]:
        """The words of the command line that makes it."""
        if self.kind == "bench":
            return [program, "bench", "photon-maps", *self.arguments, "--json", *self._device_words()]
        words = [program, "render", self.scene, "-o", image, "--stats", statistics]
        words += ["--integrator", self.integrator] if self.integrator else []
        words += ["--photon-map", self.photon_map] if self.photon_map else []
        words += ["--backend", self.backend, *self._device_words(), "--seed", str(self.seed)]
        words += ["--threads", str(self.threads)] if self.threads else []
        words += ["--resolution", self.resolution] if self.resolution else []
        words += ["--crop", self.crop] if self.crop else []
        words += ["--passes", str(self.passes)] if self.passes else []
        words += ["--spp", str(self.spp or self.eye_samples)] if self.spp or self.eye_samples else []
        words += ["--time", f"{self.time_s:g}s"] if self.time_s else []
        words += [word for setting in self.settings for word in ("--set", setting)]
        words += [word for plugin in self.plugins for word in ("--plugin", plugin)]
        words += ["--skip-unsupported"] if self.skip_unsupported else []
        words += ["--reference", reference] if reference else []
        return words

    def _device_words(self) -> list[str]:
        return ["--device", self.device] if self.device and self.backend == "vulkan" else []


@dataclass
class Machine:
    """Where runs are made: the program, and the names of its processor and Vulkan device. All of it goes into keys."""

    program: Path
    device: str  # --device of Vulkan runs; empty: the first
    version: str
    program_hash: str
    processor: str
    vulkan: str

    @staticmethod
    def ask(program: Path, device: str = "") -> "Machine":
        """What the program says of itself and of its devices."""
        program = program.resolve()
        version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
        found = subprocess.run([program, "devices", "--json"], capture_output=True, text=True, check=False)
        devices = json.loads(found.stdout) if found.returncode == 0 else {}
        name = _vulkan_name(devices.get("devices", []), device)
        return Machine(program, device, version, program_hash(program), processor_name(), name)

    def plain(self) -> dict:
        """As JSON has it; `from_plain` reads it again."""
        return {**asdict(self), "program": str(self.program)}

    @staticmethod
    def from_plain(plain: dict) -> "Machine":
        """The machine that `plain` wrote."""
        return Machine(**{**plain, "program": Path(plain["program"])})


def _vulkan_name(devices: list[dict], wanted: str) -> str:
    """The name and driver of the Vulkan device that --device chooses; empty where there is none."""
    vulkan = [one for one in devices if one.get("backend") == "vulkan"]
    if wanted.isdigit():
        vulkan = [one for one in vulkan if str(one.get("index")) == wanted]
    elif wanted:
        vulkan = [one for one in vulkan if wanted.lower() in one["name"].lower()]
    return " ".join(str(vulkan[0].get(word, "")) for word in ("name", "driver")).strip() if vulkan else ""


def processor_name() -> str:
    """The processor, as the system names it."""
    try:
        text = Path("/proc/cpuinfo").read_text()
        return re.search(r"model name\s*:\s*(.+)", text).group(1)
    except (OSError, AttributeError):
        return platform.processor() or platform.machine()


@cache
def file_hash(path: Path) -> str:
    """SHA-256 of a file's content."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@cache
def program_hash(program: Path) -> str:
    """Of the program and of the project's library that it loads: what decides a result, whatever its version."""
    found = subprocess.run(["ldd", program], capture_output=True, text=True, check=False).stdout
    libraries = sorted(Path(path).resolve() for path in re.findall(r"=> (\S*liblampyris\S*)", found))
    return hashlib.sha256("".join(file_hash(one) for one in [program, *libraries]).encode()).hexdigest()


@cache
def scene_hash(scene: Path) -> str:
    """Of a scene's text and of every file that it names, whatever they are called: includes, meshes, images."""
    seen: dict[Path, str] = {}
    open_files = [scene]
    while open_files:
        path = open_files.pop()
        if path in seen:
            continue
        seen[path] = file_hash(path)
        if path.suffix == ".pbrt":
            for name in _FILE_NAME.findall(path.read_bytes()):
                named = path.parent / name.decode(errors="replace")
                if named.exists():
                    open_files.append(named)
    return hashlib.sha256("".join(sorted(seen.values())).encode()).hexdigest()


def inputs_of(run: Run, machine: Machine) -> dict:
    """Everything that a run's result depends on; the key is its hash."""
    plain = asdict(run.but(reference=None))
    plain["plugins"] = [file_hash(ROOT / plugin) for plugin in run.plugins]
    plain["scene_content"] = scene_hash(ROOT / run.scene) if run.scene else ""
    plain["program"] = machine.program_hash
    if isinstance(run.reference, Run):
        plain["reference"] = key_of(run.reference, machine)
    elif run.reference:
        plain["reference"] = file_hash(ROOT / run.reference)
    plain["machine"] = machine.vulkan if run.backend == "vulkan" else ""
    if run.measures_time or run.kind == "bench" or run.time_s:
        plain["processor"] = machine.processor
    return plain


def key_of(run: Run, machine: Machine) -> str:
    """The name that a run's result is kept under."""
    text = json.dumps(inputs_of(run, machine), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:KEY_DIGITS]


def to_plain(run: Run) -> dict:
    """A run as JSON has it; `from_plain` reads it again."""
    plain = asdict(run.but(reference=None))
    plain["reference"] = to_plain(run.reference) if isinstance(run.reference, Run) else run.reference
    return plain


def from_plain(plain: dict) -> Run:
    """The run that `to_plain` wrote."""
    reference = plain["reference"]
    lists = {key: tuple(plain[key]) for key in ("settings", "plugins", "arguments")}
    return Run(**{**plain, **lists, "reference": from_plain(reference) if isinstance(reference, dict) else reference})

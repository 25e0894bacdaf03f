"""Faults of disks, streams, inputs and devices: docs/faults.md lists them with their outcome, and is made by this file:

python tests/cli/faults_test.py > docs/faults.md
"""

import ctypes
import gzip
import os
import resource
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # where pytest does not, when this file is a program
from support.render_program import SCENE  # noqa: E402

SMALL = {"--resolution": "16x8", "--passes": "1"}
PATIENCE = 60  # seconds
DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "faults.md"


@dataclass
class Fault:
    """What is wrong, what the program is given, and what becomes of it."""

    what: str
    arguments: list
    code: int
    message: str = ""  # part of what the program says
    prepare: object = lambda folder: None  # makes it wrong
    before: object = None  # called in the process of the program, before that starts
    written: tuple = ()  # files that are there afterwards
    outcome: str = ""  # what is left, in words
    scene: object = "scene.pbrt"
    output: str = "o.exr"  # of the option -o; empty: none
    environment: dict = field(default_factory=dict)
    streams: dict = field(default_factory=dict)


# ---- Preparations ----------------------------------------------------------------------------------------------------


def has_folder(name, mode=0o755):
    return lambda folder: (folder / name).mkdir(mode=mode)


def has_pipe(name):
    return lambda folder: os.mkfifo(folder / name)


def has_link(name, target):
    return lambda folder: (folder / name).symlink_to(target)


def has_file(name, content, mode=0o644):
    def prepare(folder):
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        (folder / name).chmod(mode)

    return prepare


def says(statement, *others):
    """The scene ends with a statement."""

    def prepare(folder):
        (folder / "scene.pbrt").write_text(SCENE + statement + "\n")
        for other in others:
            other(folder)

    return prepare


def has_odd_name(folder):
    shutil.copy(folder / "scene.pbrt", os.fsencode(folder) + b"/n\xff.pbrt")


def inflates_without_end(folder):
    (folder / "a.pbrt").write_bytes(gzip.compress(bytes(300 << 20), 1))


def without_privileges():
    """Root reads and writes what it likes; without these two capabilities, permissions count for it, too."""
    libc = ctypes.CDLL(None, use_errno=True)
    drop, override, read_search = 24, 1, 2  # the kernel's numbers of capabilities
    for capability in (override, read_search):
        libc.prctl(drop, capability, 0, 0, 0)


def limited(what, size):
    return lambda: resource.setrlimit(what, (size, size))


FULL = has_link("full.exr", "/dev/full")
SAVED = "the image was saved as"
HANGS = ["--plugin", "{build}/test_plugins/hangs.so", "--integrator", "hangs", "--passes", "9"]
VULKAN = ["--backend", "vulkan"]
PICTURE = 'Texture "t" "spectrum" "imagemap" "string filename" '
MESH = 'Shape "plymesh" "string filename" '
ELSEWHERE = "it is outside of the scene's folder"
NO_FILE = "it is not a regular file"
NO_READER = "no program reads from this pipe"

# fmt: off
OUTPUTS = [
    Fault("the folder of the image does not exist", [], 1, "the folder 'none' cannot be opened", output="none/o.exr"),
    Fault("the image is a folder", [], 1, "it is a folder", has_folder("o.exr")),
    Fault("the image's folder is a file", [], 1, "scene.pbrt", output="scene.pbrt/o.exr"),
    Fault("the image has an unknown format", [], 1, ".exr", output="o.gif"),
    Fault("a folder that may not be written to", [], 2, "Permission denied", has_folder("closed", 0o500),
          without_privileges, output="closed/o.exr"),
    Fault("an image that may not be written to", [], 2, "Permission denied", has_file("o.exr", "older", 0o400),
          without_privileges, outcome="the older image stays"),
    Fault("a file system that takes no files", [], 2, "cannot write '/proc/o.exr'", output="/proc/o.exr"),
    Fault("a name of 256 bytes", [], 2, "File name too long", output="n" * 252 + ".exr"),
    Fault("a name of 255 bytes", [], 0, written=["n" * 251 + ".exr"], output="n" * 251 + ".exr",
          outcome="the image is written"),
    Fault("a link to a file that does not exist", [], 0, "", has_link("o.exr", "target.exr"), written=["target.exr"],
          outcome="that file is written"),
    Fault("a link to itself", [], 2, "Too many levels of symbolic links", has_link("o.exr", "o.exr")),
    Fault("image and statistics are one file", ["--stats", "./o.exr"], 1, "are the same file"),
    Fault("image and checkpoint are one file", ["--checkpoint", "o.exr"], 1, "are the same file"),
    Fault("image and statistics are one file by a link", ["--stats", "link"], 1, "are the same file",
          has_link("link", "o.exr")),
    Fault("the statistics are the scene", ["--stats", "scene.pbrt"], 1, "are the same file"),
    Fault("the image is the reference", ["--reference", "o.exr"], 1, "are the same file",
          has_file("o.exr", "kept"), outcome="the reference stays"),
    Fault("the folder of the statistics does not exist", ["--stats", "none/s.json"], 1, "'none'"),
    Fault("the folder of the checkpoint does not exist", ["--checkpoint", "none/c"], 1, "'none'"),
    Fault("the disk is full", [], 2, SAVED, FULL, output="full.exr"),
    Fault("the disk is full, and there is no TMPDIR", [], 2, SAVED, FULL, output="full.exr",
          environment={"TMPDIR": "/no/such/folder"}),
    Fault("one image of two cannot be written", ["-o", "o.pfm", "--stats", "s.json"], 2, SAVED, FULL,
          output="full.exr", written=["o.pfm", "s.json"], outcome="the others are written"),
    Fault("the statistics cannot be written", ["--stats", "full.exr"], 2, "the file of statistics was saved as", FULL,
          written=["o.exr"], outcome="the image is written"),
    Fault("the image is larger than a file may be", ["--resolution", "64x64"], 2, "File too large",
          has_file("o.exr", "older"), limited(resource.RLIMIT_FSIZE, 4096), outcome="the older image stays"),
    Fault("the image's folder vanishes meanwhile", HANGS, 2, SAVED, has_folder("gone"), output="gone/o.pfm",
          environment={"HANGS": "remove gone"}),
    Fault("the checkpoint's folder vanishes meanwhile", [*HANGS, "--checkpoint", "gone/c"], 0,
          "the checkpoint is not up to date", has_folder("gone"), written=["o.exr"],
          environment={"HANGS": "remove gone"}, outcome="the rendering goes on"),
    Fault("a pipe that nobody reads", [], 2, NO_READER, has_pipe("o.exr")),
    Fault("statistics to a pipe that nobody reads", ["--stats", "p"], 2, NO_READER, has_pipe("p"), written=["o.exr"],
          outcome="the image is written"),
]

INPUTS = [
    Fault("the scene does not exist", [], 1, "none.pbrt: error: the scene cannot be read", scene="none.pbrt"),
    Fault("the scene is a folder", [], 1, "it is a directory", scene="."),
    Fault("the scene is a pipe", [], 1, NO_FILE, has_pipe("p"), scene="p"),
    Fault("the scene is a device", [], 1, NO_FILE, scene="/dev/zero"),
    Fault("the scene may not be read", [], 1, "Permission denied", has_file("a.pbrt", SCENE, 0), without_privileges,
          scene="a.pbrt"),
    Fault("the scene's name is not UTF-8", ["--stats", "s.json"], 0, "", has_odd_name, scene=b"n\xff.pbrt",
          written=["o.exr", "s.json"], outcome="image and statistics are written"),
    Fault("a scene that is cut off", [], 1, "the gzip'd data ends too early",
          has_file("a.pbrt", gzip.compress(SCENE.encode())[:-20]), scene="a.pbrt"),
    Fault("a scene that inflates without end", [], 1, "the gzip'd data becomes more than 64 times as large",
          inflates_without_end, scene="a.pbrt"),
    Fault("a scene that includes a pipe", [], 1, NO_FILE, says('Include "p"', has_pipe("p"))),
    Fault("a scene that includes another folder's file", [], 1, ELSEWHERE, says('Include "/etc/passwd"')),
    Fault("an image texture that is a pipe", [], 1, "there is no image file",
          says(PICTURE + '"p.png"', has_pipe("p.png"))),
    Fault("an image texture from another folder", [], 1, ELSEWHERE, says(PICTURE + '"../../a.png"')),
    Fault("a mesh that is a pipe", [], 1, "there is no file", says(MESH + '"p.ply"', has_pipe("p.ply"))),
    Fault("a mesh from another folder", [], 1, ELSEWHERE, says(MESH + '"/dev/zero"')),
    Fault("the scene names an image elsewhere", [], 1, "outside of the working folder",
          has_file("scene.pbrt", SCENE.replace("named.exr", "/tmp/named.exr")), output=""),
    Fault("the reference is a pipe", ["--reference", "p.exr"], 1, NO_FILE, has_pipe("p.exr")),
    Fault("the plugin is a device", ["--plugin", "/dev/zero"], 1, NO_FILE),
    Fault("the checkpoint is a pipe", ["--checkpoint", "p", "--resume"], 1, "'p'", has_pipe("p")),
    Fault("the checkpoint is damaged", ["--checkpoint", "c", "--resume"], 1, "c", has_file("c", "LAMY" * 50)),
]

STREAMS = [
    Fault("standard output is full", [], 2, "No space left", streams={"stdout": "/dev/full"}),
    Fault("standard error is full", [], 0, streams={"stderr": "/dev/full"}),
    Fault("nobody reads standard output", [], 2, streams={"stdout": "broken"}),
    Fault("nobody reads standard error", [], 0, streams={"stderr": "broken"}),
    Fault("there is no standard input", [], 0, before=lambda: os.close(0)),
]
for one in STREAMS:
    one.written, one.outcome = ["o.exr"], "the image is written"

FIRST_PASS = "the image of the first pass is written"
DEVICES = [
    Fault("the device does not exist", [*VULKAN, "--device", "99"], 2, "99"),
    Fault("there is no Vulkan driver", VULKAN, 2, "Vulkan",
          environment={"VK_ICD_FILENAMES": "/none.json", "VK_DRIVER_FILES": "/none.json"}),
    Fault("less memory is allowed than it takes", ["--max-memory", "1K"], 2, "--max-memory"),
    Fault("the program takes more memory than is allowed", [*HANGS, "--max-memory", "512M"], 2, "--max-memory allows",
          written=["o.exr"], environment={"HANGS": "eats memory"}, outcome="the image of the passes before is written"),
    Fault("the machine has too little memory", ["--resolution", "8000x8000"], 2, "memory",
          before=limited(resource.RLIMIT_AS, 3 << 30)),
    Fault("the device is lost in the second pass", HANGS, 2, "the device was lost", written=["o.exr"],
          environment={"HANGS": "device lost"}, outcome=FIRST_PASS),
    Fault("memory is exhausted in the second pass", HANGS, 2, "out of memory", written=["o.exr"],
          environment={"HANGS": "no memory"}, outcome=FIRST_PASS),
    Fault("the shader cache is a file", [*VULKAN, "--set", "backend.cache={folder}/scene.pbrt"], 0, written=["o.exr"],
          outcome="shaders are compiled anew"),
    Fault("there is no folder for the shader cache", VULKAN, 0, written=["o.exr"],
          environment={"HOME": "/none", "XDG_CACHE_HOME": "/proc/none"}, outcome="shaders are compiled anew"),
]
# fmt: on

FAULTS = {"outputs": OUTPUTS, "inputs": INPUTS, "streams": STREAMS, "devices": DEVICES}


def stream(kind):
    if kind != "broken":
        return os.open(kind, os.O_WRONLY)
    reading, writing = os.pipe()
    os.close(reading)
    return writing


def outcome_of(fault, program, build_dir, folder):
    """The exit code, and what was said."""
    options = [one.format(build=build_dir, folder=folder) for one in fault.arguments]
    for name, value in SMALL.items():
        options += [name, value] if name not in options else []
    output = ["-o", fault.output] if fault.output else []
    (folder / "tmp").mkdir()
    streams = {name: stream(kind) for name, kind in fault.streams.items()}
    try:
        done = subprocess.run(
            [str(program), "render", fault.scene, *output, *options],
            **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **streams},
            cwd=folder,
            env={**os.environ, "TMPDIR": str(folder / "tmp"), **fault.environment},
            preexec_fn=fault.before,
            timeout=PATIENCE,
            check=False,
        )
    finally:
        for opened in streams.values():
            os.close(opened)
    return done.returncode, b"".join(text for text in (done.stdout, done.stderr) if text).decode(errors="replace")


@pytest.mark.parametrize(
    "fault", [pytest.param(one, id=one.what.replace(" ", "-")) for group in FAULTS.values() for one in group]
)
def test_a_fault_has_the_documented_outcome(program, build_dir, tmp_path, fault):
    (tmp_path / "scene.pbrt").write_text(SCENE)
    fault.prepare(tmp_path)
    code, said = outcome_of(fault, program, build_dir, tmp_path)
    assert code == fault.code, said
    assert fault.message in said
    for name in fault.written:
        assert (tmp_path / name).stat().st_size > 0
    if "older" in fault.outcome:
        assert (tmp_path / "o.exr").read_bytes() == b"older"
    if " saved as" in fault.message:
        saved = Path(said.split("saved as '")[1].split("'")[0])
        assert saved.stat().st_size > 0
        saved.unlink()
    assert not list(tmp_path.glob("**/*.part"))


def document():
    lines = [
        "# Faults and their outcome",
        "",
        "What becomes of a rendering when something is wrong with its files, streams or devices. Made by",
        "`tests/cli/faults_test.py`, which brings about each of them. Exit codes: 0 done, 1 the scene or the arguments",
        "are wrong, 2 the machine cannot. Every failure is told on standard error, unless nobody reads it.",
    ]
    for title, faults in FAULTS.items():
        lines += ["", f"## {title.capitalize()}", ""]
        lines += ["| what is wrong | exit code | part of the message, and what is left |", "|---|---|---|"]
        for fault in faults:
            parts = [f'"{fault.message}"' if fault.message else "", fault.outcome]
            lines.append(f"| {fault.what} | {fault.code} | {'; '.join(filter(None, parts))} |")
    return "\n".join(lines) + "\n"


def test_the_page_is_up_to_date():
    assert DOCUMENT.read_text() == document()


if __name__ == "__main__":
    sys.stdout.write(document())

"""How much code a structure's kernels are: lines of its files without comments and blank ones."""

import re
from pathlib import Path

from lab.runs import ROOT

KINDS = ("construction", "gathering", "shared")
_OF_STRUCTURE = re.compile(r'#include "(accel/[^"]+)"')


def code_lines(text: str) -> int:
    """Lines that hold more than comments and blanks. Kernels have no strings in which a comment could seem to begin."""
    lines, within = 0, False
    for line in text.splitlines():
        kept = ""
        rest = line
        while rest:
            if within:
                _, ended, rest = rest.partition("*/")
                within = not ended
                continue
            opened, line_comment = rest.find("/*"), rest.find("//")
            if line_comment >= 0 and not 0 <= opened < line_comment:
                kept, rest = kept + rest[:line_comment], ""
            elif opened >= 0:
                kept, rest, within = kept + rest[:opened], rest[opened + 2 :], True
            else:
                kept, rest = kept + rest, ""
        lines += bool(kept.strip())
    return lines


def kernel_folder(structure: dict) -> Path:
    """Where a structure of methods.toml has its kernels."""
    return ROOT / structure.get("kernels", f"src/accel/photons/{structure['use'].partition(':')[0]}")


def kind_of(file: Path) -> str | None:
    """What a header is for; None for parameters, and for headers of the host."""
    if file.name.endswith(".kernel.h"):
        return "construction"
    if file.name.endswith(".gather.h"):
        return "gathering"
    return None if file.name.endswith("_params.h") or "#pragma once" in file.read_text() else "shared"


def kernel_files(folder: Path) -> list[Path]:
    """The kernels' files of a folder, and those of other structures that they include."""
    found = {file: None for file in sorted(folder.glob("*.h")) if kind_of(file)}
    waiting = list(found)
    while waiting:
        for name in _OF_STRUCTURE.findall(waiting.pop().read_text()):
            included = ROOT / "src" / name
            if included.exists() and kind_of(included) and included not in found:
                found[included] = None
                waiting.append(included)
    return list(found)


def kernel_rows(structures: dict[str, dict]) -> list[dict]:
    """Files and lines of each structure; None where its folder is not there (a plugin without its source)."""
    rows = []
    for name, structure in structures.items():
        files = kernel_files(kernel_folder(structure))
        counts = {file: code_lines(file.read_text()) for file in files}
        of_kind = {kind: sum(count for file, count in counts.items() if kind_of(file) == kind) for kind in KINDS}
        rows.append({"structure": name, "files": len(files) or None, "lines": sum(of_kind.values()) or None, **of_kind})
    return rows

"""How much code a structure's kernels are: lines of its files without comments and blank ones."""

import re
from pathlib import Path

from lab.runs import ROOT

SUFFIXES = (".kernel.h", ".gather.h", ".layout.h")
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
    return ROOT / structure.get("kernels", f"src/accel/{structure['use'].partition(':')[0]}")


def kernel_files(folder: Path) -> list[Path]:
    """The kernels' files of a folder, and those of other structures that they include."""
    found = {file: None for file in sorted(folder.glob("*.h")) if file.name.endswith(SUFFIXES)}
    waiting = list(found)
    while waiting:
        for name in _OF_STRUCTURE.findall(waiting.pop().read_text()):
            included = ROOT / "src" / name
            if included.name.endswith(SUFFIXES) and included.exists() and included not in found:
                found[included] = None
                waiting.append(included)
    return list(found)


def kernel_rows(structures: dict[str, dict]) -> list[dict]:
    """Files and lines of each structure; None where its folder is not there (a plugin without its source)."""
    rows = []
    for name, structure in structures.items():
        files = kernel_files(kernel_folder(structure))
        counts = {file: code_lines(file.read_text()) for file in files}
        of_suffix = [sum(count for file, count in counts.items() if file.name.endswith(one)) for one in SUFFIXES]
        row = {"structure": name, "files": len(files) or None, "lines": sum(of_suffix) or None}
        rows.append({**row, **dict(zip(("construction", "gathering", "shared"), of_suffix, strict=True))})
    return rows

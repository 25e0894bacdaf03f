"""Comments name files and symbols that exist."""

import re
import subprocess

import pytest

C_SUFFIXES, OTHER_SUFFIXES = (".h", ".cpp", ".glsl", ".in"), (".py", ".cmake", "CMakeLists.txt")
C_TOKENS = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|//[^\n]*|/\*.*?\*/', re.DOTALL)
OTHER_TOKENS = re.compile(r'""".*?"""|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|#[^\n]*', re.DOTALL)
FILE = re.compile(r"[\w./-]*\w\.(?:h|cpp|py|md|cmake|glsl|toml|pbrt)\b(?!\.in)")
# Words of several parts, and what is called.
SYMBOL = re.compile(
    r"\b[a-zA-Z]\w*_\w+\b|\b[a-z]\w*(?=\(\))|\b[a-z]+[A-Z]\w*\b|\b[A-Z][a-z0-9]+[A-Z]\w*\b|\bk[A-Z]\w+\b"
)
# Names of other projects, and of mathematics.
FOREIGN = {
    *("oneTBB", "OpenCV", "LeakSanitizer", "UBSAN_OPTIONS", "McPeak", "DeVore", "NaNs", "max_map_count", "access"),
    *("NoContraction", "VK_KHR_acceleration_structure", "vkCmdUpdateBuffer"),
    *("DiffuseAreaLight", "DisablePixelJitter", "FilmBaseParameters", "SpotLight", "twoSided"),  # pbrt-v4's
    *("cpu/integrators.cpp", "cameras.cpp"),  # pbrt-v4's
    *("R_i", "R_n", "int_0", "dmu_o", "gamma_3", "Phi_i", "tau_n", "e_r", "e_phi", "dP", "dA", "n_d", "sum_b", "sum_c"),
    *("se_ref", "se_ours"),
}
# Examples, and patterns of names.
PLACEHOLDER = re.compile(r"NAME|EFFECT_X|add_hello|core/kernel/x\.h|\w+_$")


def split(text, tokens):
    """The code of a file, strings included, and its comments as (line, text)."""
    code, comments, end = [], [], 0
    for match in tokens.finditer(text):
        token = match.group(0)
        code.append(text[end : match.start()])
        end = match.end()
        if token.startswith(("//", "/*", "#")):
            comments.append((text.count("\n", 0, match.start()) + 1, token))
        else:
            code.append(token)
    return "\n".join([*code, text[end:]]), comments


def stale_names(files, tracked):
    """'file:line: name' for each name in comments that neither the code of these (file, text) nor `tracked` has."""
    known = set(re.findall(r"[A-Za-z_]\w*", " ".join(tracked)))
    comments = []
    for name, text in files:
        code, own = split(text, C_TOKENS if name.endswith(C_SUFFIXES) else OTHER_TOKENS)
        known.update(re.findall(r"[A-Za-z_]\w*", code))
        comments += [(f"{name}:{line}", comment) for line, comment in own]
    stale = []
    for place, comment in comments:
        missing = [name for name in FILE.findall(comment) if not any(file.endswith(name) for file in tracked)]
        missing += sorted(set(SYMBOL.findall(FILE.sub("", comment))) - known)
        stale += [f"{place}: {name}" for name in missing if name not in FOREIGN and not PLACEHOLDER.search(name)]
    return stale


def test_comments_name_what_exists(source_dir):
    listed = subprocess.run(["git", "ls-files"], cwd=source_dir, capture_output=True, text=True, check=False)
    if listed.returncode != 0:
        pytest.skip("not a checkout: which files are the project's is not known")
    tracked = listed.stdout.split()
    folders = ("src/", "bench/", "tests/", "examples/", "cmake/", "tools/", "experiments/")
    sources = [name for name in tracked if name.startswith(folders) and name.endswith(C_SUFFIXES + OTHER_SUFFIXES)]
    assert len(sources) > 300
    files = [(name, (source_dir / name).read_text()) for name in sources if (source_dir / name).exists()]
    assert stale_names(files, tracked) == []


def test_names_that_do_not_exist_are_found():
    text = '// As old_name() and gone.h say; new_name, kOld and kNew.\nint new_name = kNew("kOld");  // OldClass\n'
    assert stale_names([("a.cpp", text)], ["a.cpp"]) == [
        "a.cpp:1: gone.h",
        "a.cpp:1: old_name",
        "a.cpp:2: OldClass",
    ]

"""The list of mutants fits the code: each can be put in by tools/mutants.py, and the tests that it names are there."""

import importlib.util
import re
import sys

import pytest


@pytest.fixture(scope="module")
def tool(source_dir):
    spec = importlib.util.spec_from_file_location("mutants", source_dir / "tools/mutants.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["mutants"] = module  # its dataclass looks itself up
    spec.loader.exec_module(module)
    return module


def test_each_mutant_changes_one_place(tool):
    mutants = tool.read_list()
    assert len(mutants) >= 40
    for mutant in mutants:
        before = (tool.ROOT / mutant.file).read_bytes()
        for switched in (False, True):
            assert tool.mutated(mutant.file, [mutant], switched) != before


def test_each_text_is_an_expression_or_statements(tool):
    """Or else the build with all mutants fails, since it puts them into brackets."""
    for mutant in tool.read_list():
        for text in (mutant.old, mutant.new):
            depths = [text[:end].count("(") - text[:end].count(")") for end in range(len(text) + 1)]
            assert min(depths) == depths[-1] == 0, f"{mutant.name}: {text}"
            assert not text.startswith(("||", "&&", "*", "/", "+", "?", ":", ",")), f"{mutant.name}: {text}"


def test_each_mutant_names_tests(tool, source_dir):
    known = {path.stem for path in source_dir.glob("tests/*/*_test.cpp")}
    for mutant in tool.read_list():
        assert mutant.ctest or mutant.pytest, mutant.name
        assert set(re.findall(r"\w+_test\b", mutant.ctest)) <= known, mutant.name
        for file in mutant.pytest:
            assert (source_dir / "tests" / file.split("::")[0]).is_file(), mutant.name

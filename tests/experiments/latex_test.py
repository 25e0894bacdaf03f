"""Tables as LaTeX: special characters, numbers, rules."""

from lab.latex import escaped, latex_table
from lab.sections import Column, Section, Table

TABLE = Table(
    "a table",
    "Cost & error",
    [Column("method", "method"), Column("error", "relMSE"), Column("time", "time", "s"), Column("note", "note_1")],
    [
        {"method": "path_tracing", "error": 1.2345e-7, "time": 12, "note": "50 % of {x}"},
        {"method": "sppm", "error": None, "time": 3.14159, "note": "> 2^3 ~ \\ #1 $"},
    ],
    "With `--spp 4`.",
)


def test_what_is_special_is_escaped():
    assert escaped("a_b & 5 % {x} \\ ~^") == r"a\_b \& 5 \% \{x\} \textbackslash{} \textasciitilde{}\textasciicircum{}"
    assert escaped("say `a_b` now") == r"say \texttt{a\_b} now"


def test_a_table_has_booktabs_rules_and_numbers_to_the_right(tmp_path):
    lines = latex_table(TABLE).splitlines()
    assert r"  \begin{tabular}{lrrl}" in lines
    assert r"  \caption{Cost \& error. With \texttt{--spp 4}.}" in lines
    assert r"  \label{tab:a-table}" in lines
    rows = [line.strip() for line in lines[lines.index(r"    \midrule") + 1 : lines.index(r"    \bottomrule")]]
    assert rows[0] == r"path\_tracing & $1.23\cdot 10^{-7}$ & $12$ & 50 \% of \{x\} \\"
    assert rows[1].startswith(r"sppm & -- & $3.14$ & \textgreater{} 2\textasciicircum{}3")
    assert lines.index(r"    \toprule") < lines.index(r"    \midrule") < lines.index(r"    \bottomrule")
    Section("a", "A", "b", tables=[TABLE], answer=Table("answer", "Which", [Column("x", "x")], [{"x": 1}])).write(
        tmp_path
    )
    assert (tmp_path / "a table.tex").read_text() == latex_table(TABLE)
    assert (tmp_path / "answer.tex").is_file()


def test_braces_and_cells_balance():
    text = latex_table(TABLE)
    plain = text.replace(r"\{", "").replace(r"\}", "")
    assert plain.count("{") == plain.count("}")
    cells = [line.replace(r"\&", "").count("&") for line in text.splitlines() if line.endswith(r"\\")]
    assert cells == [3, 3, 3]

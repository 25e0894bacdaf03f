"""Tables for a paper: LaTeX with booktabs, the same cells as the page's."""

import re

SPECIAL = {
    "\\": r"\textbackslash{}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "–": "--",
    "−": "$-$",
    "×": r"$\times$",
    "\N{NO-BREAK SPACE}": "~",
}
_BROKEN = re.compile("|".join(map(re.escape, SPECIAL)))
_POWER = re.compile(r"^(-?[0-9.]+)e([+-]?[0-9]+)$")


def latex_table(table) -> str:
    """A `table` environment for \\usepackage{booktabs}: numbers to the right, rules where booktabs has them."""
    numeric = {column.key: _is_numeric([row.get(column.key) for row in table.rows]) for column in table.columns}
    heads = [f"{one.title} [{one.unit}]" if one.unit else one.title for one in table.columns]
    lines = [
        "% Needs \\usepackage{booktabs}.",
        r"\begin{table}",
        r"  \centering",
        f"  \\caption{{{escaped(_sentence(table.title) + (f' {table.caption}' if table.caption else ''))}}}",
        f"  \\label{{tab:{re.sub(r'[^A-Za-z0-9-]+', '-', table.id)}}}",
        f"  \\begin{{tabular}}{{{''.join('r' if numeric[one.key] else 'l' for one in table.columns)}}}",
        r"    \toprule",
        f"    {' & '.join(escaped(head) for head in heads)} \\\\",
        r"    \midrule",
    ]
    for row in table.rows:
        cells = [_cell(row.get(column.key), column.digits) for column in table.columns]
        lines.append(f"    {' & '.join(cells)} \\\\")
    lines += [r"    \bottomrule", r"  \end{tabular}", r"\end{table}"]
    return "\n".join(lines) + "\n"


def escaped(text: str) -> str:
    """Text with LaTeX's special characters as such; backticks around code make it typewriter."""
    parts = re.split(r"`([^`]+)`", text)
    plain = [_BROKEN.sub(lambda found: SPECIAL[found.group()], part) for part in parts]
    return "".join(rf"\texttt{{{part}}}" if i % 2 else part for i, part in enumerate(plain))


def _sentence(text: str) -> str:
    return text if text.endswith((".", "?", "!")) else f"{text}."


def _is_numeric(values: list) -> bool:
    found = [value for value in values if value not in (None, "")]
    return bool(found) and all(isinstance(one, int | float) and not isinstance(one, bool) for one in found)


def _cell(value, digits: int) -> str:
    if value is None or value == "":
        return "--"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return ", ".join(_cell(one, digits) for one in value)
    if not isinstance(value, int | float):
        return escaped(str(value))
    text = str(value) if isinstance(value, int) else f"{value:.{digits}g}"
    power = _POWER.match(text)
    return rf"${power[1]}\cdot 10^{{{int(power[2])}}}$" if power else f"${text}$"

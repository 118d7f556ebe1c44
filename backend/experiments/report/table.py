"""Table: lines of words, as Markdown, HTML, LaTeX and CSV."""

from __future__ import annotations

import csv
import html
import io
from collections.abc import Sequence
from dataclasses import dataclass

LATEX = {
    **{sign: "\\" + sign for sign in "&%$#_{}"},
    **{"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": "$<$", ">": "$>$"},
}
BREAK = "\n"
"""Within an entry."""


@dataclass(frozen=True)
class Table:
    """A table that says what it is."""

    name: str
    """Of its file."""
    title: str
    header: Sequence[str]
    lines: Sequence[Sequence[str]]
    note: str = ""

    def markdown(self) -> str:
        """With its title in bold."""
        rows = [self.header, ["---"] * len(self.header), *self.lines]
        body = "\n".join("| " + " | ".join(map(_markdown, row)) + " |" for row in rows)
        return f"**{self.title}**\n\n{body}\n" + (f"\n{self.note}\n" if self.note else "")

    def html(self) -> str:
        """As an HTML table with a caption."""
        head = "".join(f"<th>{_html(cell)}</th>" for cell in self.header)
        body = "".join("<tr>" + "".join(f"<td>{_html(cell)}</td>" for cell in line) + "</tr>\n" for line in self.lines)
        note = f"<p class=note>{_html(self.note)}</p>" if self.note else ""
        title = f"<caption>{_html(self.title)}</caption>"
        return f"<table>{title}<thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table>{note}\n"

    def latex(self) -> str:
        """For booktabs; entries of two lines use ``makecell``'s ``\\makecell``."""
        rows = [" & ".join(map(_latex, row)) + r" \\" for row in (self.header, *self.lines)]
        columns = "l" + "c" * (len(self.header) - 1)
        body = "\n".join([r"\toprule", rows[0], r"\midrule", *rows[1:], r"\bottomrule"])
        note = f"\n% {self.note}" if self.note else ""
        return (
            f"\\begin{{table*}}\n\\centering\n\\caption{{{_latex(self.title)}}}\n"
            f"\\begin{{tabular}}{{{columns}}}\n{body}\n\\end{{tabular}}{note}\n\\end{{table*}}\n"
        )

    def csv(self) -> str:
        """Entries of several lines are put in one."""
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(
            [_flat(cell, "; ") for cell in row] for row in (self.header, *self.lines)
        )
        return text.getvalue()


def _flat(cell: str, joint: str) -> str:
    return cell.replace(BREAK, joint)


def _markdown(cell: str) -> str:
    return _flat(cell, "<br>").replace("|", r"\|")


def _html(text: str) -> str:
    return html.escape(text).replace(BREAK, "<br>")


def _latex(text: str) -> str:
    escaped = ["".join(LATEX.get(sign, sign) for sign in line) for line in text.split(BREAK)]
    return escaped[0] if len(escaped) == 1 else r"\makecell{" + r" \\ ".join(escaped) + "}"

"""The report of a grid, as HTML that opens offline, Markdown, LaTeX, CSV, and JSON for other pages."""

from __future__ import annotations

import html
import json
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path

from backend.errors import InvalidInputError, StorageError
from backend.experiments.grid.cells import Plan
from backend.experiments.grid.row import GridRow
from backend.experiments.grid.settings import JudgeName
from backend.experiments.report import tables
from backend.experiments.report.analysis import Cell, Rows
from backend.experiments.report.figures import Figure, as_html, as_table, figures, script
from backend.experiments.report.pairs import comparisons, odd_pairs
from backend.experiments.report.table import Table
from backend.files import replacing

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 1400px; margin: 2em auto; padding: 0 1em; color: #222 }
table { border-collapse: collapse; margin: 2em 0 .3em; font-size: 13px; font-variant-numeric: tabular-nums }
caption { text-align: left; font-weight: 600; padding-bottom: .4em }
td, th { padding: .25em .7em; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top }
.note { color: #555; font-size: 13px; margin: 0 0 1.5em; max-width: 60em }
details { margin: 1em 0 } .wide { overflow-x: auto }
"""
LONG = ("cells", "pairs_by_task", "by_distance", "by_speed")
"""Tables that are folded in HTML and only named in Markdown; their CSV files have them."""


@dataclass(frozen=True)
class Report:
    """All that is told of a grid."""

    facts: list[str]
    """What the rows are, one sentence each."""
    tables: list[Table]
    figures: list[Figure]
    papers_tables: list[Table]
    """Those of ``tables`` that are the paper's."""
    cells: list[Cell]

    def markdown(self) -> str:
        """The facts and the tables, the long ones by the name of their file."""
        parts = ["# Report of a grid\n", "\n".join(f"- {fact}" for fact in self.facts) + "\n"]
        parts += [table.markdown() for table in self.tables if table.name not in LONG]
        parts += [f"{table.title}: `{table.name}.csv`\n" for table in self.tables if table.name in LONG]
        return "\n".join(parts)

    def html(self) -> str:
        """One file with everything in it."""
        facts = "".join(f"<li>{html.escape(fact).replace('`', '')}</li>" for fact in self.facts)
        parts = [f"<div class=wide>{t.html()}</div>" for t in self.tables if t.name not in LONG]
        folded = [
            f"<details><summary>{html.escape(t.title)}</summary><div class=wide>{t.html()}</div></details>"
            for t in self.tables
            if t.name in LONG
        ]
        body = "\n".join(
            [*parts[: len(self.papers_tables)], *map(as_html, self.figures), *parts[len(self.papers_tables) :], *folded]
        )
        return (
            f"<!doctype html><html lang=en><meta charset=utf-8><title>Report of a grid</title><style>{STYLE}</style>"
            f"{script()}<h1>Report of a grid</h1><ul>{facts}</ul>{body}</html>\n"
        )

    def json(self) -> str:
        """Facts, tables and figures, for a page that shows them in its own way."""
        listed = [
            {**asdict(table), "folded": table.name in LONG, "papers": table in self.papers_tables}
            for table in self.tables
        ]
        return json.dumps({"facts": self.facts, "tables": listed, "figures": list(map(as_table, self.figures))})

    def write(self, folder: Path) -> list[Path]:
        """``report.html``, ``.md`` and ``.json``, ``table.tex`` and a CSV per table; raises ``StorageError``."""
        latex = "\n".join(table.latex() for table in self.papers_tables)
        texts = {"report.html": self.html(), "report.md": self.markdown(), "report.json": self.json()}
        texts["table.tex"] = latex
        texts |= {f"{table.name}.csv": table.csv() for table in self.tables}
        try:
            for name, text in texts.items():
                with replacing(folder / name) as file:
                    file.write(text.encode())
        except OSError as error:
            raise StorageError(f"Cannot write the report to {folder}: {error.strerror}.") from error
        return [folder / name for name in texts]


def report_of(found: list[GridRow], plan: Plan, judge: JudgeName) -> Report:
    """The report of a grid's rows; raises ``InvalidInputError`` when there are none."""
    if not found:
        raise InvalidInputError("The grid has no rows yet, so there is nothing to report.")
    settings = plan.settings
    order = (settings.robots, settings.tasks, settings.methods)
    rows = Rows(found, judge).ordered(*order)
    linear = Rows([row for row in found if row.task == "linear"], judge).ordered(*order)
    cells = rows.cells()
    compared = comparisons(rows, rows.methods[0])
    papers = tables.papers_tables(cells, rows)
    return Report(
        facts=_facts(rows, plan),
        tables=[
            *papers,
            tables.pairs_table(compared, single_tasks=False),
            *tables.share_tables(rows, linear),
            tables.reasons_table(rows),
            tables.cycles_table(rows),
            tables.cells_table(cells),
            tables.pairs_table(compared, single_tasks=True),
        ],
        figures=figures(rows, linear, cells),
        papers_tables=papers,
        cells=cells,
    )


def _facts(rows: Rows, plan: Plan) -> list[str]:
    s = plan.settings
    errors = sum(row.reason == "error" for row in rows.all)
    odd = odd_pairs(rows)
    judge = {"strict": "held 5 cm up by the hand alone, no obstacle moved", "authors": "ended 3 cm above its start"}
    facts = [
        f"{len(rows.all)} of {plan.trials} trials.",
        f"Joint speeds `{s.profile}`, thinking charged by `{s.think}`, judged by `{rows.judge}`: {judge[rows.judge]}.",
    ]
    facts += [f"Conditions: {', '.join(s.set)}."] if s.set else []
    facts += [f"{errors} trials ended in an error; they count as failures."] if errors else []
    facts.append(
        f"{odd} trials did not begin the same under every method: their rows are not of one code."
        if odd
        else "Trials of the same robot, task, object and index began identically under every method."
    )
    for name, word in (("code", "Code"), ("machine", "Machine")):
        counts = Counter(getattr(row, name) for row in rows.all)
        facts.append(f"{word}: {'; '.join(f'{value} ({n} trials)' for value, n in counts.most_common())}.")
    return facts

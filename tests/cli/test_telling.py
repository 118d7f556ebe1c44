"""Laws of progress: one line with a bar on a terminal, few plain lines elsewhere, the first and the last always."""

import io
import re
from collections.abc import Iterable

import pytest
from rich.console import Console

from backend.cli.telling import BAR_WIDTH, LINE_EVERY_S, Teller, share


def on_a_terminal(texts: Iterable[str], width: int = 80) -> list[str]:
    """The lines that stand on a terminal in the end."""
    out = io.StringIO()
    tell = Teller("mico", "cube", console=Console(file=out, force_terminal=True, width=width))
    for text in texts:
        tell(text)
    screen: list[str] = [""]
    for piece in re.findall(r"\x1b\[1A|\x1b\[2K|\n|[^\x1b\n]+", re.sub(r"\x1b\[[\d;]*m|\r", "", out.getvalue())):
        match piece:
            case "\x1b[1A":
                assert screen.pop() == "", "the cursor is at the beginning of a line"
            case "\x1b[2K":
                screen[-1] = ""
            case "\n":
                screen.append("")
            case _:
                screen[-1] += piece
    assert screen.pop() == "", "the shell's prompt begins its own line"
    return [line.rstrip() for line in screen]


def in_a_file(texts: Iterable[tuple[float, str]]) -> list[str]:
    """The lines that are written where there is no terminal; each text comes at its time, s."""
    out, now_s = io.StringIO(), [0.0]
    tell = Teller(console=Console(file=out, width=20), clock=lambda: now_s[0])
    for now_s[0], text in texts:
        tell(text)
    return out.getvalue().splitlines()


def test_on_a_terminal_news_of_one_thing_take_each_others_place():
    walks = ["walk 1 changed 3.25 mm", "walk 2 changed 0 mm"]
    lines = on_a_terminal(["12 of 40 lifts", "40 of 40 lifts", *walks, "done"])
    assert lines == [
        "━" * BAR_WIDTH + " mico cube: 40 of 40 lifts",
        "mico cube: walk 2 changed 0 mm",
        "mico cube: done",
    ]


def test_on_a_terminal_the_bar_grows():
    out = io.StringIO()
    tell = Teller(console=Console(file=out, force_terminal=True, color_system="standard"))
    lengths: list[int] = []
    for done in (10, 20, 40):
        tell(f"{done} of 40")
        first_color = re.split(r"\x1b\[[\d;]*m", out.getvalue().splitlines()[-1])[1]
        lengths.append(len(first_color.strip()))
    assert lengths == [BAR_WIDTH // 4, BAR_WIDTH // 2, BAR_WIDTH]


def test_on_a_narrow_terminal_all_is_said_and_all_rows_are_replaced():
    text = "{} of 40 grasps, and much more that would not find room in one row of so few columns"
    lines = on_a_terminal([text.format(3), text.format(4), "Stopping: one moment", text.format(5)], width=60)
    first = next(i for i, line in enumerate(lines) if "Stopping" in line)
    for number, rows in ((4, lines[:first]), (5, lines[first + 1 :])):
        assert len(rows) > 1
        assert " ".join(row.strip("━╸╺ ") for row in rows) == f"mico cube: {text.format(number)}"


def test_elsewhere_lines_come_now_and_then_the_first_and_the_last_always():
    steps = [
        (float(n), f"step {n} of 100, loss {1 / n:.3f}, a line longer than the console is wide") for n in range(1, 101)
    ]
    lines = in_a_file([*steps, (101.0, "learning"), (102.0, "90 lifts"), (103.0, "95 lifts"), (104.0, "done")])
    told = [int(line.split()[1]) for line in lines if line.startswith("step")]
    assert told == [1, 1 + LINE_EVERY_S, 1 + 2 * LINE_EVERY_S, 1 + 3 * LINE_EVERY_S, 100]
    assert lines[len(told) :] == ["learning", "90 lifts", "95 lifts", "done"]


@pytest.mark.parametrize(
    ("text", "done"),
    [
        ("round 2: 30 of 120 at 8 lifts", 0.25),
        ("branches from postures 70 %", 0.7),
        ("3986 of 0", None),
        ("0.75 of lifts hold", None),
        ("annealing: 12 distinct grasps from 40 chains", None),
        ("50 of 40", 1.0),
    ],
)
def test_how_much_is_done_is_read_from_the_words(text: str, done: float | None):
    assert share(text) == done

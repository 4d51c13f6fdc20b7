"""README and docs/ as data: their code blocks, their tables, and what a block prints."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from harness import ROOT

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), ROOT / "examples" / "README.md"]
"""Every page whose commands and listings are run."""


@dataclass(frozen=True)
class Block:
    """A fenced block: ```` ```language words ````."""

    language: str
    words: tuple[str, ...]
    """Words after the language: a file's name, or `norun`."""
    text: str
    line: int


def page_name(page: Path) -> str:
    return str(page.relative_to(ROOT))


def blocks(page: Path) -> list[Block]:
    found, fence, start = [], None, 0
    lines: list[str] = []
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if fence is None and line.startswith("```"):
            fence, start, lines = line[3:].split(), number, []
            assert fence, f"{page_name(page)}:{number}: a block without a language"
        elif fence is not None and line == "```":
            found.append(Block(fence[0], tuple(fence[1:]), "\n".join(lines) + "\n", start))
            fence = None
        else:
            lines.append(line)
    assert fence is None, f"{page_name(page)}:{start}: this block does not end"
    return found


@dataclass(frozen=True)
class Command:
    """A line of a `console` block after `$ `, and the lines of output shown below it."""

    line: str
    shown: list[str]


def commands(block: Block) -> list[Command]:
    found: list[Command] = []
    for line in block.text.splitlines():
        if line.startswith("$ "):
            found.append(Command(line[2:], []))
        elif found and found[-1].line.endswith("\\"):
            found[-1] = Command(f"{found[-1].line}\n{line.removeprefix('> ')}", [])
        else:
            assert found, f"output without a command: {line}"
            found[-1].shown.append(line)
    return found


NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")

ROUNDING = 1e-9
"""Below this a number is what rounding left, which differs from machine to machine."""


def same_line(shown: str, printed: str) -> bool:
    """Whether two lines are the same up to the last digit of each number and to rounding; `…` in the
    one that is shown stands for any text."""
    if shown == printed:
        return True
    if "…" in shown:
        return re.fullmatch(".*".join(map(re.escape, shown.split("…"))), printed) is not None
    if NUMBER.split(shown.rstrip()) != NUMBER.split(printed.rstrip()):
        return False
    pairs = zip(NUMBER.findall(shown), NUMBER.findall(printed), strict=True)
    return all(same_number(a, b) for a, b in pairs)


def same_number(shown: str, printed: str) -> bool:
    a, b = float(shown), float(printed)
    if max(abs(a), abs(b)) < ROUNDING:
        return True
    digits, _, exponent = shown.partition("e")
    decimals = len(digits.partition(".")[2])
    return abs(a - b) <= 1.01 * 10.0 ** (int(exponent or 0) - decimals)


def same_output(shown: list[str], printed: list[str]) -> bool:
    """Whether what a page shows is what was printed; a line `…` stands for any lines."""
    while shown and not shown[-1]:
        shown = shown[:-1]
    while printed and not printed[-1]:
        printed = printed[:-1]
    if not shown:
        return not printed
    if shown[0].strip() == "…":
        return any(same_output(shown[1:], printed[n:]) for n in range(len(printed) + 1))
    return bool(printed) and same_line(shown[0], printed[0]) and same_output(shown[1:], printed[1:])


def tables(page: Path) -> Iterator[tuple[str, list[list[str]]]]:
    """The tables of a page, each with the heading that it stands under: rows of cells."""
    heading, rows = "", []
    for line in [*page.read_text(encoding="utf-8").splitlines(), ""]:
        if line.startswith("|"):
            cells = re.split(r"(?<!\\)\|", line.strip("|"))
            rows.append([cell.strip().replace("\\|", "|") for cell in cells])
        elif rows:
            # Without the head and the line below it.
            yield heading, rows[2:]
            rows = []
        if line.startswith("#"):
            heading = line.lstrip("#").strip()


def words(cell: str) -> list[str]:
    """Returns the texts in backquotes in a cell."""
    return re.findall(r"`([^`]+)`", cell)

"""String literals of Rust sources, and which of them are messages for people."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from harness import ROOT

SOURCES = [ROOT / "src", ROOT / "crates/tools/src"]

TOKEN = re.compile(
    r"""//[^\n]*|/\*.*?\*/"""  # comments
    r"""|c?r(?P<hashes>\#*)"(?P<raw>.*?)"(?P=hashes)"""
    r"""|[bc]?"(?P<plain>(?:\\.|[^"\\])*)\""""
    r"""|b?'(?:\\[^']*'|\\''|[^'\\]')""",  # characters, lest one be a quote
    re.DOTALL | re.VERBOSE,
)

PLACEHOLDER = re.compile(r"\{[^{}]*\}")


@dataclass(frozen=True)
class Literal:
    """A string in a source file, its placeholders written `…`."""

    text: str
    file: str
    line: int
    before: str
    """The code that leads to it, in one line."""

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.text}"


def sources(folders: Iterable[Path] = SOURCES) -> Iterator[tuple[str, str]]:
    """The files of folders, those of both libraries, with their text, tests left out."""
    for folder in folders:
        for path in sorted(folder.rglob("*.rs")):
            name = path.relative_to(folder).as_posix()
            if "/tests" not in name:
                yield name, path.read_text(encoding="utf-8").split("#[cfg(test)]\nmod tests {")[0]


def shown(literal: str) -> str:
    """Returns the text of a literal, with `…` for each placeholder."""
    joined = re.sub(r"\\\n\s*", "", literal)
    unescaped = joined.replace('\\"', '"').replace("\\n", " ").replace("\\\\", "\\")
    return PLACEHOLDER.sub("…", unescaped.replace("{{", "{").replace("}}", "}"))


def literals(name: str, text: str) -> list[Literal]:
    """All string literals of a file but those in comments."""
    found, code, end = [], "", 0
    for token in TOKEN.finditer(text):
        code = (code + text[end : token.start()])[-200:]
        end = token.end()
        content = token["raw"] if token["raw"] is not None else token["plain"]
        if content is not None:
            line = text.count("\n", 0, token.start()) + 1
            found.append(Literal(shown(content), name, line, " ".join(code.split())))
    return found


def reported(name: str, text: str) -> Iterator[Literal]:
    """The literals that a file of the reader gives to its diagnostics as their message."""
    strings: list[Literal] = literals(name, text)
    # Each string becomes its number, so that brackets and commas are those of the code.
    numbers = iter(range(len(strings)))

    def number(token: re.Match) -> str:
        is_string = token["raw"] is not None or token["plain"] is not None
        return f'"{next(numbers)}"' if is_string else ""

    code = TOKEN.sub(number, text)
    arguments = {
        r"ExpressionError::new": 1,
        r"Diagnostic::(?:error|warning)": 1,
        r"(?:self|context)\s*\.(?:error|warn)": 2,
    }
    places = [
        split_arguments(code, call.end())[index]
        for function, index in arguments.items()
        for call in re.finditer(rf"(?<![\w:]){function}\(", code)
    ]
    places += re.findall(r"let message = (.*?);\n", code, re.DOTALL)
    places += re.findall(r"#\[error\((.*?)\)\]", code, re.DOTALL)
    for place in places:
        yield from (strings[int(n)] for n in re.findall(r'"(\d+)"', place))


def split_arguments(code: str, start: int) -> list[str]:
    """The arguments of a call whose bracket was opened just before `start`."""
    depth, parts = 0, [""]
    for character in code[start:]:
        depth += (character in "([{") - (character in ")]}")
        if depth < 0:
            break
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return parts

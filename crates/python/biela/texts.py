"""Texts of mechanism files from data, and files written."""

from __future__ import annotations

import html
import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Union

import numpy as np

from .errors import FileError, UsageError

Source = Union[str, Mapping[str, Any]]
"""Mechanism file as text, or as data: what `tomllib.loads` returns for one."""

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def text_of(source: Any) -> str:
    """Returns the text of a mechanism file; that of data is written here.

    >>> print(text_of({"format": 1, "bodies": {"arm": {"markers": {"A": [0, "length"]}}}}))
    format = 1
    <BLANKLINE>
    [bodies.arm]
    markers = { A = [0, "length"] }
    <BLANKLINE>
    """
    if isinstance(source, str):
        return source
    if not isinstance(source, Mapping):
        raise UsageError(f"expected the text of a mechanism file or a mapping; found {source!r}")
    lines = [f"{_key(key)} = {_value(value, key)}" for key, value in source.items() if not _is_table(value)]
    for name, table in source.items():
        if not _is_table(table):
            continue
        # What is named has a header of its own, as in files that people write.
        named = {key: value for key, value in table.items() if name == "bodies" and _is_table(value)}
        own = {key: value for key, value in table.items() if key not in named}
        for path, entries in [((name,), own), *(((name, key), value) for key, value in named.items())]:
            if entries or not named:
                lines += ["", f"[{'.'.join(map(_key, path))}]"]
                lines += [f"{_key(key)} = {_value(value, key)}" for key, value in entries.items()]
    return "\n".join(lines) + "\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping)


def _key(key: Any) -> str:
    """Returns a key of TOML."""
    if not isinstance(key, str):
        raise UsageError(f"expected keys as text; found {key!r}")
    return key if _BARE.fullmatch(key) else _value(key, key)


def _value(value: Any, key: str) -> str:
    """Returns a value of TOML, that of the key."""
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        # TOML escapes as JSON does, and this character besides.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        entries = [f"{_key(name)} = {_value(entry, name)}" for name, entry in value.items()]
        return f"{{ {', '.join(entries)} }}" if entries else "{}"
    if isinstance(value, Sequence):
        return f"[{', '.join(_value(entry, key) for entry in value)}]"
    raise UsageError(f"`{key}` is {value!r}; expected text, a number, true or false, a list or a mapping")


def written(path: str | os.PathLike, content: str | bytes) -> Path:
    """Writes a file and returns its path."""
    try:
        path = Path(path)
        path.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
    except TypeError:
        raise UsageError(f"path: expected the path of a file; found {path!r}") from None
    except (OSError, ValueError) as error:
        missing = isinstance(error, FileNotFoundError) and not path.parent.is_dir()
        why = f"there is no folder `{path.parent}`" if missing else getattr(error, "strerror", None) or error
        raise FileError(f"cannot write `{path}`: {why}") from None
    return path


def table(headers: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Returns a table of HTML; nothing without rows."""
    if not rows:
        return ""
    line = lambda tag, cells: "<tr>" + "".join(f"<{tag}>{html.escape(c)}</{tag}>" for c in cells) + "</tr>"
    return f"<table>{line('th', headers)}{''.join(line('td', row) for row in rows)}</table>"

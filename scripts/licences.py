"""Write the files licenses.txt: the licences of what is inside the runtime libraries, the solvers for
browsers, and the program with its Python module.

    scripts/licences.py           writes the files
    scripts/licences.py --check   fails if they are out of date

The texts go into each FMU's documentation/licenses, into each page and into releases. Needs cargo and Python 3.10 or newer.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RUNTIME_TARGETS = (
    "x86_64-unknown-linux-gnu",
    "x86_64-pc-windows-gnu",
    "x86_64-apple-darwin",
    "aarch64-unknown-linux-gnu",
    "aarch64-apple-darwin",
)
# Each file with its package, the targets of that, and the words about what holds it.
NOTICES = {
    ROOT / "crates" / "runtime" / "licenses.txt": (
        "biela-runtime",
        RUNTIME_TARGETS,
        "The library in binaries/ is biela",
        "resources/",
    ),
    ROOT / "crates" / "page" / "licenses.txt": (
        "biela-page",
        ("wasm32-unknown-unknown",),
        "The solver in this page is biela",
        "this page",
    ),
    ROOT / "crates" / "studio" / "licenses.txt": (
        "biela-studio",
        ("wasm32-unknown-unknown",),
        "The solver in this page is biela",
        "this page",
    ),
    # The module holds the program, too.
    ROOT / "crates" / "python" / "licenses.txt": (
        "biela-python",
        RUNTIME_TARGETS,
        "This is biela, the program and the Python module",
        "your file",
    ),
}
# Licences in the order in which one is chosen where a crate leaves the choice, each with words of
# its text and of the names of its files.
CHOICE = (
    ("MIT", "Permission is hereby granted", ("MIT",)),
    ("Zlib", "This software is provided 'as-is'", ("ZLIB",)),
    ("BSD-3-Clause", "Redistribution and use in source and binary forms", ("BSD",)),
    ("BSD-2-Clause", "Redistribution and use in source and binary forms", ("BSD",)),
    ("Apache-2.0", "Apache License", ("APACHE",)),
    ("Unicode-3.0", "UNICODE LICENSE V3", ("UNICODE",)),
)
LINE = "-" * 80


def cargo(*arguments):
    command = ["cargo", *arguments]
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


def alternatives(expression):
    """Sets of licences, of which each suffices, of an SPDX expression."""
    tokens = re.findall(r"\(|\)|[^\s()/]+|/", expression)
    tokens = ["OR" if token == "/" else token for token in tokens]

    def either():
        found = both()
        while tokens and tokens[0] == "OR":
            tokens.pop(0)
            found = found + both()
        return found

    def both():
        found = single()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            found = [a | b for b in single() for a in found]
        return found

    def single():
        token = tokens.pop(0)
        if token == "(":
            found = either()
            tokens.pop(0)
            return found
        if tokens[:1] == ["WITH"]:
            token += " WITH " + tokens[1]
            del tokens[:2]
        return [{token}]

    return either()


def packages():
    metadata = json.loads(cargo("metadata", "--format-version", "1", "--locked"))
    return {(p["name"], p["version"]): p for p in metadata["packages"]}


def inside(known, package, targets):
    """The crates that are linked into a package of ours, without biela's own."""
    found = set()
    for target in targets:
        tree = cargo(
            "tree", "--locked", "--package", package, "--no-default-features",
            "--edges", "normal,no-proc-macro", "--target", target, "--prefix", "none",
            "--format", "{p}",
        )  # fmt: skip
        for line in tree.splitlines():
            name, version = line.split()[:2]
            found.add((name, version.removeprefix("v")))
    return [known[key] for key in sorted(found) if known[key]["source"]]


def text_of(package):
    """The licence chosen for a crate, and the text that comes with it."""
    offered = alternatives(package["license"] or "")
    folder = Path(package["manifest_path"]).parent
    files = sorted(f for f in folder.iterdir() if re.match(r"(?i)(licen[cs]e|copying|unlicense)", f.name))
    order = [licence for licence, *_ in CHOICE]
    usable = [licences for licences in offered if licences <= set(order)]
    if not usable:
        sys.exit(f"{package['name']}: no known licence in `{package['license']}`")
    # One licence rather than several; of one, in the order of choice, one whose text comes along.
    texts = {}
    for licence, words, names in CHOICE:
        for file in sorted(files, key=lambda f: not any(n in f.name.upper() for n in names)):
            text = file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""
            if words in text:
                texts[licence] = "\n".join(line.rstrip() for line in text.strip().splitlines())
                break
    chosen = min(usable, key=lambda s: (len(s), not s <= texts.keys(), max(map(order.index, s))))
    chosen = sorted(chosen, key=order.index)
    authors = ", ".join(re.sub(r" <[^>]*>", "", a) for a in package["authors"])
    authors = authors or "the authors of " + package["name"]
    told = [texts.get(licence, f"{licence}, by {authors}") for licence in chosen]
    return " and ".join(chosen), "\n\n".join(told)


def notices(known, package, targets, what, place):
    texts = {}
    for package in inside(known, package, targets):
        licence, text = text_of(package)
        texts.setdefault((licence, text), []).append(f"{package['name']} {package['version']}")
    mit, apache = ((ROOT / f"LICENSE-{name}").read_text().strip() for name in ("MIT", "APACHE"))
    parts = [
        f"{what}, under the MIT licence or the Apache License 2.0, at your\n"
        "option. It contains Rust's standard library, under the same two licences, by the Rust project's\n"
        f"contributors, and the Rust crates listed below under their licences. The mechanism in {place}\n"
        "belongs to its author.",
        "biela, MIT:\n\n" + mit,
        "biela and Rust's standard library, Apache-2.0:\n\n" + apache,
    ]
    for (licence, text), names in sorted(texts.items(), key=lambda item: item[1]):
        if text == apache:
            text = "The text is the one of the Apache License 2.0 above."
        parts.append(f"{', '.join(names)}, {licence}:\n\n{text}")
    return f"\n\n{LINE}\n\n".join(parts) + "\n"


def main():
    known = packages()
    for path, about in NOTICES.items():
        text, name = notices(known, *about), path.relative_to(ROOT)
        if sys.argv[1:] == ["--check"]:
            if not path.exists() or path.read_text(encoding="utf-8") != text:
                sys.exit(f"{name} is out of date: run `make licences`")
            continue
        path.write_text(text, encoding="utf-8")
        print(f"wrote {name}")


main()

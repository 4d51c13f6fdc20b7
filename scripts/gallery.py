"""Writes the gallery into target/gallery: each shipped mechanism as a page on which it is moved by
hand, and an index of their pictures. One static folder; the pages share one solver, and lead to the
studio of `make studio`, if there is one."""

import html
import re
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "target" / "gallery"
STUDIO = ROOT / "target" / "studio"
PROGRAM = ROOT / "target" / "release" / "biela"
SOLVER = "solver.js"

PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>Mechanisms to move by hand</title>
<link rel="icon" href="data:,">
<style>
body {{ margin: 0 auto; max-width: 80rem; padding: 1rem; font: 1rem/1.5 system-ui, Helvetica, Arial, sans-serif; }}
ul {{ display: grid; grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); gap: 1rem; margin: 0; padding: 0; list-style: none; }}
a {{ display: block; height: 100%; box-sizing: border-box; padding: 0.75rem; border: 1px solid #8888; border-radius: 8px; color: inherit; text-decoration: none; }}
a:hover, a:focus-visible {{ border-color: #0072b2; }}
img {{ display: block; width: 100%; height: 11rem; object-fit: contain; background: #fff; border-radius: 4px; }}
b {{ display: block; margin-top: 0.5rem; }}
</style>
</head>
<body>
<h1>Mechanisms to move by hand</h1>
<p>Planar mechanisms, each a short text file. Pull a body, change a length: the solver is in the page.</p>
<ul>
{entries}
</ul>
</body>
</html>
"""


def description(text: str) -> str:
    """The file's description of its mechanism, empty if it has none."""
    found = re.search(r'^description = "((?:[^"\\]|\\.)*)"', text, re.MULTILINE)
    return found[1] if found else ""


def main() -> None:
    OUT.mkdir(parents=True, exist_ok=True)
    studio = []
    if (STUDIO / "index.html").is_file():
        shutil.copytree(STUDIO, OUT / "studio", dirs_exist_ok=True)
        studio = ["--studio", "studio/index.html"]
    else:
        print("without `make studio`, the pages do not lead to a studio")
    entries = []
    for file in sorted((ROOT / "mechanisms").glob("*.toml")):
        name = file.stem
        page = OUT / f"{name}.html"
        subprocess.run([PROGRAM, "page", file, "--share", SOLVER, *studio, "-o", page], check=True)
        picture = OUT / f"{name}.svg"
        subprocess.run([PROGRAM, "draw", file, "-o", picture], check=True)
        text = html.escape(description(file.read_text(encoding="utf-8")))
        entries.append(
            f'<li><a href="{name}.html"><img src="{name}.svg" alt="" loading="lazy">'
            f"<b>{html.escape(name.replace('_', ' '))}</b> {text}</a></li>"
        )
    index = PAGE.format(entries="\n".join(entries))
    (OUT / "index.html").write_text(index, encoding="utf-8")
    size = sum(part.stat().st_size for part in OUT.rglob("*") if part.is_file())
    print(f"{OUT / 'index.html'}: {len(entries)} mechanisms, {size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()

"""Settings of Sphinx for `make docs`: the Markdown files of the project, where they are, as a site."""

import posixpath
import re
from pathlib import Path

from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]
GALLERY = ROOT / "target" / "gallery"

project = "biela"
extensions = ["myst_parser"]
root_doc = "README"
include_patterns = [
    "README.md",
    "CHANGELOG.md",
    "docs/*.md",
    *(f"{folder}/README.md" for folder in ("mechanisms", "examples", "crates/benches", "tests")),
]
exclude_patterns = [".*", "target"]
# The anchors of headings down to this level, made as where the files are read on the web.
myst_heading_anchors = 4
# Blocks of output are no complete programs.
suppress_warnings = ["misc.highlighting_failure"]

html_theme = "furo"
html_title = "biela"
html_extra_path = ["front"]
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = html_show_copyright = html_copy_source = False


def tables_of_contents() -> str:
    """Returns the navigation: the tables in the index of the documentation, under their headings."""
    parts = ["```{toctree}\n:hidden:\n\ndocs/README\n```\n"]
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    for section in index.split("\n## ")[1:]:
        caption, _, rows = section.partition("\n")
        paths = re.findall(r"^\| \[[^]]+\]\(([^)]+)\.md\)", rows, re.MULTILINE)
        pages = [posixpath.normpath(f"/docs/{path}") for path in paths]
        parts.append("\n".join(["```{toctree}", ":hidden:", f":caption: {caption}", "", *pages, "```\n"]))
    return "\n" + "\n".join(parts)


def linked(text: str, folder: Path, pages: set[str]) -> str:
    """Returns a page whose links to folders lead to their pages, or are text where they have none."""

    def replaced(link: re.Match) -> str:
        target = (folder / link["path"]).resolve()
        if not target.is_dir():
            return link[0]
        page = (target / "README").relative_to(ROOT).as_posix()
        return f"[{link['text']}]({link['path']}/README.md)" if page in pages else link["text"]

    return re.sub(r"\[(?P<text>[^][]+)\]\((?P<path>[^)#:\s]+?)/?\)", replaced, text)


def mechanisms(text: str) -> str:
    """Returns the page of the mechanisms with links below its headings: Sphinx takes none in them.

    One leads to the file, one to the page on which the mechanism is moved by hand, if it was made.
    """

    def replaced(heading: re.Match) -> str:
        name = heading[1]
        links = f"[{name}.toml]({name}.toml)"
        if (GALLERY / f"{name}.html").is_file():
            links += f', <a href="../gallery/{name}.html">moved by hand</a>'
        return f"### {name}\n\n{links}"

    text = re.sub(r"^### \[(\w+)\]\(.*$", replaced, text, flags=re.MULTILINE)
    if not (GALLERY / "index.html").is_file():
        return text
    title, _, rest = text.partition("\n")
    return f'{title}\n\n<a href="../gallery/index.html">All of them</a> can be moved by hand.\n{rest}'


def source_read(app: Sphinx, name: str, source: list[str]) -> None:
    """Changes a page before it is read."""
    folder = (ROOT / name).parent
    source[0] = linked(source[0], folder, app.env.found_docs)
    if name == "mechanisms/README":
        source[0] = mechanisms(source[0])
    if name == root_doc:
        source[0] += tables_of_contents()


def setup(app: Sphinx) -> None:
    """Takes part in the building of the site."""
    app.connect("source-read", source_read)

"""Every command and script in README, docs/ and examples/ runs, and prints what the page shows.

The blocks of a page run one after the other in one folder, which has what a checkout has. Blocks
that name a file (```` ```toml piston.toml ````) write it; `console` blocks have commands after
`$ ` with their output below, `sh` blocks commands alone; a `text` block right after a `python`
block is what that prints.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from harness import ROOT, program, run_biela
from manual import PAGES, Block, blocks, commands, page_name, same_output

NOT_RUN = {
    "make install": "writes below the home folder; CI's own machine does without",
    "make runtimes && make install": "likewise",
    "make studio && make install": "likewise",
    "make runtimes page wheel": "likewise",
    "pip install target/wheels/biela-*manylinux*": "`make test-install` does",
    "py -m pip install biela-0.1.0-cp39-abi3-win_amd64.whl": "for Windows; `make test-platforms` installs it for Wine",
    "py -m biela new my_linkage --from four_bar": "likewise; test_mechanism.py runs the module as the program",
    "py -m biela check my_linkage.toml": "likewise",
    "biela new my_linkage --from four_bar": "for macOS; `make test-install` runs it",
    "biela check my_linkage.toml": "likewise",
    "make wheel": "builds for minutes, from the libraries of `make runtimes`",
    "make wheel ONLY=linux64": "likewise",
    "make runtimes": "builds for minutes, with compilers that are not everywhere",
    "make runtimes ONLY='linux64 win64'": "likewise",
    "python3 -m venv env": "for packages to be downloaded into",
    "env/bin/pip install -r requirements.txt": "downloads packages; the tests have their own lock",
    "biela watch piston.toml": "runs until it is ended; crates/tools/tests/program/watch.rs has tests of its own",
    "biela studio": "runs until it is ended; crates/tools/tests/program/studio.rs has tests of its own",
    "biela studio four_bar.toml": "likewise",
    "biela studio piston.toml": "likewise",
    "make studio": "builds for minutes; `make test-studio` draws in it",
    "biela page piston.toml -o piston.html": "needs `make page`; tests/page has tests of its own",
    "env/bin/python parameter_sweep.py": "test_examples.py runs it",
    "env/bin/python dask_sweep.py": "test_examples.py runs it",
    "env/bin/python sweep_on_dask.py": "test_examples.py runs it",
    "env/bin/python dc_motor.py": "test_examples.py runs it",
    "env/bin/python step_errors.py": "docs/fmu.md runs it",
    "env/bin/python system/walker.py": "it runs further below",
    "env/bin/python system/crane.py": "it runs further below",
    "env/bin/python system/press.py": "it runs further below",
}
"""Commands in blocks marked `norun`, each with the reason."""

SECONDS = 120
"""More than any block may take, in a debug build on a busy machine."""


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    """A folder with the program and its library alone, whatever else has been built."""
    folder = tmp_path_factory.mktemp("bin")
    built = program()
    for file in (built, *built.parent.glob("*biela_runtime.*")):
        if file.suffix != ".d":
            shutil.copy2(file, folder)
    return folder


@pytest.mark.parametrize("page", PAGES, ids=page_name)
def test_page(page, tmp_path, monkeypatch, programs):
    monkeypatch.setenv("PATH", str(programs), prepend=os.pathsep)
    checkout(tmp_path)
    folder = tmp_path / "examples" if page.parent.name == "examples" else tmp_path
    previous, printed = None, []
    for block in blocks(page):
        at = f"{page_name(page)}:{block.line}"
        if block.language == "text":
            assert previous == "python", f"{at}: output of nothing"
            compare(at, block.text.splitlines(), printed)
        elif "norun" in block.words:
            check_not_run(at, block)
        elif block.language == "console":
            run_console(at, block, folder)
        elif block.language == "sh":
            run(at, ["bash", "-euo", "pipefail", "-c", block.text], folder)
        elif block.language == "python":
            script = folder / (block.words[0] if block.words else "script.py")
            script.write_text(block.text, encoding="utf-8")
            printed = run(at, [sys.executable, script.name], folder)
        elif block.words:
            (folder / block.words[0]).write_text(block.text, encoding="utf-8")
        else:
            assert block.language in {"toml", "csv"}, f"{at}: `{block.language}` is not run"
        previous = block.language


def checkout(folder):
    """Makes the files that pages refer to."""
    for name in ("mechanisms", "examples", "demo"):
        ignored = shutil.ignore_patterns("out", "__pycache__", "*.fmu")
        shutil.copytree(ROOT / name, folder / name, ignore=ignored)


def run_console(at, block: Block, folder):
    for command in commands(block):
        # A page means a failure that it shows.
        printed = run(at, ["bash", "-c", command.line], folder, may_fail=bool(command.shown))
        if command.shown:
            compare(f"{at}: {command.line}", command.shown, printed)


def run(at, command, folder, *, may_fail=False) -> list[str]:
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {
        **os.environ,
        "PATH": path,
        # The module that `make module` has built.
        "PYTHONPATH": str(ROOT / "crates" / "python"),
        "MPLBACKEND": "agg",
        "BIELA_EXAMPLE": "small",
    }
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        encoding="utf-8",
        timeout=SECONDS,
        check=False,
    )
    assert may_fail or done.returncode == 0, f"{at}:\n{done.stdout}"
    return done.stdout.splitlines()


def compare(at, shown, printed):
    if not same_output(shown, printed):
        pytest.fail(f"{at} shows\n" + "\n".join(shown) + "\nand prints\n" + "\n".join(printed))


def check_not_run(at, block: Block):
    for line in block.text.splitlines():
        command = re.sub(r"\s+#.*", "", line.removeprefix("$ ")).strip()
        assert command in NOT_RUN, f"{at}: `{command}` is not run, and NOT_RUN has no reason"


def test_no_reason_without_a_command():
    listed = {
        re.sub(r"\s+#.*", "", line.removeprefix("$ ")).strip()
        for page in PAGES
        for block in blocks(page)
        if "norun" in block.words
        for line in block.text.splitlines()
    }
    assert set(NOT_RUN) <= listed, set(NOT_RUN) - listed


@pytest.mark.parametrize("page", PAGES, ids=page_name)
def test_make_targets_exist(page):
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    # At the start of a line of a block, or in backquotes.
    for target in re.findall(r"(?:^|`)make ([a-z-]+)", page.read_text(encoding="utf-8"), re.M):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target


@pytest.mark.parametrize("page", PAGES, ids=page_name)
def test_links_lead_somewhere(page):
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        path, _, anchor = target.partition("#")
        if ":" in path:
            continue
        linked = (page.parent / path).resolve() if path else page
        assert linked.exists(), f"{page_name(page)}: {target}"
        if anchor:
            assert anchor in anchors(linked), f"{page_name(page)}: {target}"


def test_the_index_of_the_documentation_names_every_page():
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    pages = {page.name for page in (ROOT / "docs").glob("*.md")} - {"README.md"}
    assert pages == set(re.findall(r"^\| \[[\w-]+\.md\]\(([\w-]+\.md)\)", index, re.MULTILINE))


def test_the_inside_names_files_that_exist():
    page = ROOT / "docs" / "inside.md"
    named = re.findall(r"`([\w./*-]+/[\w./*-]+)`", page.read_text(encoding="utf-8"))
    # A path begins at the top, or in one of the folders that a row is about.
    homes = [ROOT, ROOT / "src", ROOT / "src/kinematics", ROOT / "src/mechanism", ROOT / "src/fmi", *(ROOT / "crates/tools/src" / f for f in ("", "drawing"))]
    assert len(named) > 20
    for path in named:
        found = [match for home in homes for match in home.glob(path)]
        assert found or "NAME" in path, path


def anchors(page):
    """The anchors of a page's headings, made as on GitHub."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_every_command_and_option_is_there():
    """docs/commands.md against what the program says of itself."""
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    listed = run_biela("--help").stdout.partition("Commands:\n")[2].partition("\n\n")[0]
    names = set(re.findall(r"^  (\w+)", listed, re.MULTILINE)) - {"help"}
    sections = set(re.findall(r"^## (\w+)$", text, re.MULTILINE))
    assert {"check", "run", "draw", "export"} <= names
    assert names == sections
    helps = [run_biela(name, "--help").stdout for name in names]
    options = set(re.findall(r"^ +(?:-\w, )?(--[a-z-]+)", "\n".join(helps), re.MULTILINE))
    documented = set(re.findall(r"--[a-z-]+", text))
    assert options - {"--help"} <= documented, options - documented

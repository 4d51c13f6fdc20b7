"""Packs a release: the archive of a platform, its wheel, and the checksums of all files.

    scripts/pack.py OUT NAME PROGRAM     writes OUT/biela-VERSION-NAME.tar.gz, or .zip for Windows
    scripts/pack.py --wheel OUT NAME WHEELS     copies the newest wheel of the platform from a folder
    scripts/pack.py --sums FOLDER        prints the checksums of its files

The same files give the same bytes: entries are sorted and have one date.
"""

import gzip
import hashlib
import io
import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RUNTIMES = ROOT / "target" / "runtimes"

# The end of the name of a wheel.
WHEELS = {
    "linux-x86_64": "manylinux*x86_64",
    "linux-aarch64": "manylinux*aarch64",
    "windows-x86_64": "win_amd64",
    "macos-x86_64": "macosx*x86_64",
    "macos-arm64": "macosx*arm64",
}


def version() -> str:
    """Returns the version of the program: the first one in its manifest."""
    manifest = (ROOT / "Cargo.toml").read_text(encoding="utf-8")
    return re.search('^version = "(.*)"$', manifest, re.MULTILINE)[1]


def content(program: Path) -> dict[str, Path]:
    """Returns the files of an archive by their paths in it."""
    files = {f"bin/{program.name}": program}
    # Those of these sources alone.
    command = ["bash", ROOT / "scripts" / "runtimes.sh", "--current"]
    current = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    files |= {f"lib/biela/{library}": RUNTIMES / library for library in current.split()}
    for solver in ("page.wasm", "studio.wasm"):
        files[f"lib/biela/{solver}"] = RUNTIMES / solver
    for pattern in ["mechanisms/*.toml", "mechanisms/*.csv", "mechanisms/README.md"]:
        files |= {f"share/biela/{path.relative_to(ROOT)}": path for path in ROOT.glob(pattern)}
    for folder in ["docs", "mechanisms/pictures"]:
        paths = [path for path in (ROOT / folder).rglob("*") if path.is_file()]
        files |= {f"share/biela/{path.relative_to(ROOT)}": path for path in paths}
    for name in ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"]:
        files[f"share/biela/{name}"] = ROOT / name
    # Of what is inside program, libraries and solvers.
    inside = {"program": "python", "runtime": "runtime", "page": "page", "studio": "studio", "editor": "studio/editor"}
    for name, folder in inside.items():
        files[f"share/biela/licenses/{name}.txt"] = ROOT / "crates" / folder / "licenses.txt"
    return dict(sorted((name.replace(os.sep, "/"), path) for name, path in files.items()))


def is_program(name: str) -> bool:
    return name.startswith(("bin/", "lib/")) and not name.endswith(".wasm")


def pack(out: Path, name: str, program: Path) -> Path:
    """Writes an archive with one folder of its own name and returns its path."""
    folder = f"biela-{version()}-{name}"
    files = content(program)
    if name.startswith("windows"):
        path = out / f"{folder}.zip"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
            for entry, file in files.items():
                info = zipfile.ZipInfo(f"{folder}/{entry}")
                # As on Linux, wherever it is packed.
                info.create_system = 3
                archive.writestr(info, file.read_bytes(), zipfile.ZIP_DEFLATED)
        return path
    path = out / f"{folder}.tar.gz"
    with (
        path.open("wb") as raw,
        gzip.GzipFile("", "wb", compresslevel=9, fileobj=raw, mtime=0) as packed,
        tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive,
    ):
        for entry, file in files.items():
            data = file.read_bytes()
            info = tarfile.TarInfo(f"{folder}/{entry}")
            info.size, info.mode = len(data), 0o755 if is_program(entry) else 0o644
            archive.addfile(info, io.BytesIO(data))
    return path


def take_wheel(out: Path, name: str, wheels: Path) -> None:
    found = wheels.glob(f"biela-{version()}-*{WHEELS[name]}.whl")
    newest = max(found, key=lambda path: path.stat().st_mtime)
    shutil.copyfile(newest, out / newest.name)


def main() -> None:
    match sys.argv[1:]:
        case ["--sums", folder]:
            for path in sorted(Path(folder).iterdir()):
                if path.name != "SHA256SUMS":
                    print(f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}")
        case ["--wheel", out, name, wheels]:
            take_wheel(Path(out), name, Path(wheels))
        case [out, name, program]:
            print(f"set-up: wrote {pack(Path(out), name, Path(program)).name}")
        case _:
            sys.exit(__doc__)


if __name__ == "__main__":
    main()

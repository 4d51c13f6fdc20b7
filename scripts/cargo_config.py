"""Write .cargo/config.toml, so that bare `cargo build` and `cargo test` find what they need.

Runs under the project's own Python (.venv) in the project's root. Says what it did, or
nothing when the file was right already: cargo then has no reason to build anything again.
"""

import json
import os
import shlex
import subprocess
import sys
import sysconfig
from pathlib import Path

CONFIG = Path(".cargo/config.toml")
MARK = "# Written by `make setup`"


def fail(what, *remedies):
    print(f"set-up failed: {what}", *(f"  {line}" for line in remedies), sep="\n", file=sys.stderr)
    sys.exit(1)


def compiler(*arguments):
    """First line of what the C compiler answers, or nothing."""
    command = shlex.split(os.environ.get("CC") or "cc") + list(arguments)
    try:
        answer = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return ""
    return answer.strip()


def compiler_headers():
    """Folder of the compiler's own headers (stddef.h and the like), which the wheel lacks."""
    asked = (compiler("-print-file-name=include"), os.path.join(compiler("-print-resource-dir"), "include"))
    for folder in asked:
        if os.path.isabs(folder) and os.path.isfile(os.path.join(folder, "stddef.h")):
            return os.path.normpath(folder)
    fail(
        "the C compiler does not say where its own headers are",
        "Set CC to gcc or clang.",
    )


def clang_arguments():
    arguments = ["-I" + compiler_headers()]
    if sys.platform == "darwin":
        sdk = subprocess.run(["xcrun", "--show-sdk-path"], capture_output=True, text=True)
        if sdk.returncode == 0:
            arguments += ["-isysroot", sdk.stdout.strip()]
    return shlex.join(arguments)


def folder_with(name, *below):
    """Folder of the first file of that name under a package, relative to the project's root."""
    site = Path(sysconfig.get_path("platlib"))
    found = sorted(site.joinpath(*below).rglob(name))
    if not found:
        fail(f"{name} is not in {site.joinpath(*below)}", "Remove .venv and try again.")
    return os.path.relpath(found[0].parent)


def is_library_folder(folder):
    return any(Path(folder).glob("libclang*")) or Path(folder).is_file()


def toml_string(text):
    # JSON's escapes are a subset of those of a TOML basic string.
    return json.dumps(text, ensure_ascii=False)


def relative(path):
    # Cargo completes it from the folder that holds .cargo, so the checkout can be moved.
    return f"{{ value = {toml_string(path)}, relative = true }}"


def main():
    libclang = folder_with("libclang.*", "clang", "native")
    lines = [
        MARK + ", which replaces it; settings of your own belong in ~/.cargo/config.toml.",
        "[env]",
        "# Variables already set in the environment win over these three.",
        f"LIBCLANG_PATH = {relative(libclang)}",
        f"BINDGEN_EXTRA_CLANG_ARGS = {toml_string(clang_arguments())}",
        f"BIELA_FMI_HEADERS = {relative(folder_with('fmi2Functions.h', 'fmpy', 'c-code'))}",
        "# Not over this one: for `make setup` the same name means the Python to build .venv on.",
        'BIELA_PYTHON = { value = ".venv/bin/python", relative = true, force = true }',
    ]
    text = "\n".join(lines) + "\n"

    theirs = os.environ.get("LIBCLANG_PATH")
    if theirs is not None and not is_library_folder(theirs):
        print(
            f"set-up: warning: LIBCLANG_PATH={theirs} is set but holds no libclang; "
            "unset it, or building will fail",
            file=sys.stderr,
        )

    old = CONFIG.read_text(encoding="utf-8") if CONFIG.exists() else None
    if old == text:
        return
    if old is not None and not old.startswith(MARK):
        fail(
            f"{CONFIG} is not of set-up's making, so it stays as it is",
            "Move its settings to ~/.cargo/config.toml, remove it, and try again.",
        )
    CONFIG.parent.mkdir(exist_ok=True)
    new = CONFIG.with_name("config.toml.new")
    new.write_text(text, encoding="utf-8")
    new.replace(CONFIG)
    print(f"wrote {CONFIG} (libclang, compiler and FMI headers, Python)")


main()

"""Exports and imports of the libraries for other platforms."""

import re
import shutil
import sys
from pathlib import Path

from common import LIBRARIES, ROOT, expect, headers, run

# Parts of Windows 10: the C library, the kernel, synchronization and random numbers.
WINDOWS_LIBRARIES = re.compile(r"kernel32|ntdll|msvcrt|bcryptprimitives|api-ms-win-(core|crt)-.*", re.I)


def declared():
    """Returns the functions of FMI 2.0 and 3.0."""
    names = set()
    for version, count in ((2, 44), (3, 75)):
        text = (headers() / f"fmi{version}Functions.h").read_text(encoding="utf-8")
        found = re.findall(rf"FMI{version}_Export\s+fmi{version}\w+\s+(fmi{version}\w+)\s*;", text)
        expect(len(found) == count, f"the header of FMI {version}.0 declares {len(found)} functions")
        names.update(found)
    return names


def inspect(library):
    """Returns exports and imports of a library; refuses one that is not as promised."""
    content = library.read_bytes()
    at = library.relative_to(LIBRARIES)
    for path in (str(ROOT), str(Path.home())):
        expect(path.encode() not in content, f"{at} carries the path {path}")
    exports, needs = {".so": elf, ".dll": pe, ".dylib": macho}[library.suffix](library)
    wanted = declared()
    expect(exports == wanted, f"{at} exports also {sorted(exports - wanted)}, and not {sorted(wanted - exports)}")
    return f"{len(content) / 1e6:.2f} MB", needs


def loading_time(library):
    """Returns the time to load a library for this system [ms], the best of some."""
    code = "import ctypes, sys, time; t = time.perf_counter(); ctypes.CDLL(sys.argv[1]); print(time.perf_counter() - t)"
    return 1e3 * min(float(run(sys.executable, "-c", code, library)) for _ in range(10))


def elf(library):
    exports = {line.split()[-1] for line in run("nm", "-D", "--defined-only", library).splitlines() if line.strip()}
    versions = {tuple(map(int, v.split("."))) for v in re.findall(r"GLIBC_([\d.]+)", run("readelf", "-V", library))}
    expect(max(versions) <= (2, 17), f"{library} wants glibc {max(versions)}")
    needed = re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-d", library))
    allowed = re.compile(r"(libc|libm|libdl|libpthread|librt|ld-linux.*)\.so\.\d")
    expect(all(allowed.fullmatch(name) for name in needed), f"{library} needs {needed}")
    return exports, f"glibc {'.'.join(map(str, max(versions)))}: {', '.join(needed)}"


def pe(library):
    text = run("x86_64-w64-mingw32-objdump", "-p", library)
    needed = sorted({name.removesuffix(".dll").lower() for name in re.findall(r"DLL Name: (.*)", text)})
    expect(all(WINDOWS_LIBRARIES.fullmatch(name) for name in needed), f"{library} needs {needed}")
    table = text.split("[Ordinal/Name Pointer] Table")[1].split("\n\n")[0]
    return {line.split()[-1] for line in table.splitlines() if "[" in line}, ", ".join(needed)


def tool(name):
    found = shutil.which(name) or shutil.which(f"{name}-14")
    expect(found, f"no {name}")
    return found


def macho(library):
    processors = {"darwin64": ("x86_64", "arm64"), "aarch64-darwin": ("arm64",)}[library.parent.name]
    exports, needs = set(), []
    for processor in processors:
        names = run(tool("llvm-nm"), "-gU", f"--arch={processor}", library)
        exports |= {line.split()[-1].removeprefix("_") for line in names.splitlines() if len(line.split()) == 3}
        commands = run(tool("llvm-objdump"), "--macho", f"--arch={processor}", "--private-headers", library)
        oldest = re.search(r"minos ([\d.]+)", commands)[1]
        signed = "signed" if "LC_CODE_SIGNATURE" in commands else "unsigned"
        expect(processor != "arm64" or signed == "signed", f"{library} is not signed")
        used = run(tool("llvm-objdump"), "--macho", f"--arch={processor}", "--dylibs-used", library).splitlines()[1:]
        used = [line.split()[0] for line in used if line.strip() and "@rpath" not in line]
        expect(all(name.startswith("/usr/lib/") for name in used), f"{library} needs {used}")
        needs.append(f"{processor}: macOS {oldest}, {signed}, {', '.join(Path(u).name for u in used)}")
    return exports, "; ".join(needs)

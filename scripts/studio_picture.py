"""Takes the picture of the studio in README: Jansen's leg, in a headless browser, with few colours so
that the file is small. The arguments are those of `biela studio`, such as --solver WASM."""

import io
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "fmpy"))

from browsing import browser  # noqa: E402  (its folder has only just been added)

PROGRAM = os.environ.get("BIELA_BIN", ROOT / "target" / "release" / "biela")
PICTURE = ROOT / "docs" / "studio.png"
COLOURS = 64

with tempfile.TemporaryDirectory() as folder:
    # The studio writes the file that it shows.
    file = shutil.copy(ROOT / "mechanisms" / "jansen_leg.toml", folder)
    command = [PROGRAM, "studio", file, "--port", "0", *sys.argv[1:]]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as studio:
        address = studio.stdout.readline().strip()
        shot = Path(folder) / "shot.png"
        subprocess.run(
            [browser(), "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
             "--disable-background-networking", "--hide-scrollbars", "--window-size=1280,760",
             f"--user-data-dir={folder}/profile", "--virtual-time-budget=60000",
             f"--screenshot={shot}", address],
            check=True, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        studio.terminate()
    content = io.BytesIO()
    Image.open(shot).convert("RGB").quantize(COLOURS).save(content, "PNG", optimize=True)
PICTURE.write_bytes(content.getvalue())
print(f"{PICTURE.relative_to(ROOT)}: {len(content.getvalue()) / 1000:.0f} kB")

"""Means of FLIP and HDR-FLIP by `ocellus diff` and by PyPI's flip-evaluator: exit code 1 if one is off by 1e-4 or more.

Usage: check.py OCELLUS [A B]...
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import flip_evaluator
import numpy as np
from PIL import Image

FIXTURES = Path(__file__).resolve().parents[3] / "fixtures"
GALLERY = ("fig2a", "fig2b"), ("fig2c", "fig2d"), ("fig5a", "fig5b"), ("fig5c", "fig5d"), ("fig4", "fig2a")
ROOMS = "spheres", "spheres_lens"
LARGEST = 1e-4


def fixture_pairs(ocellus, folder):
    """Pictures of the gallery; the reference rooms with few samples against converged, and one against the other."""
    for pair in GALLERY:
        yield tuple(FIXTURES / "gallery" / f"{name}.png" for name in pair)
    rooms = [FIXTURES / "reference" / f"{name}.exr" for name in ROOMS]
    for room in rooms:
        noisy = Path(folder) / f"{room.stem}_4spp.exr"
        command = [ocellus, "render", room.with_suffix(".toml"), "-o", noisy, "--spp", "4"]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        yield noisy, room
    yield rooms[1], rooms[0]
    yield rooms[0], rooms[1]


def read(path):
    """Linear values; the authors' program would take any PNG for sRGB, also one whose `gAMA` chunk says otherwise."""
    if Path(path).suffix == ".exr":
        return flip_evaluator.load(str(path))
    with Image.open(path) as image:
        codes = np.asarray(image.convert("RGB")) / 255
        gamma = None if "srgb" in image.info else image.info.get("gamma")
    srgb = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    return (codes ** (1 / gamma) if gamma else srgb).astype(np.float32)


def main():
    ocellus, *files = sys.argv[1:]
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        pairs = zip(files[::2], files[1::2]) if files else fixture_pairs(ocellus, folder)
        for a, b in pairs:
            hdr = Path(b).suffix == ".exr"
            output = subprocess.run([ocellus, "diff", a, b, "--json"], check=True, capture_output=True).stdout
            ours = json.loads(output)["hdr_flip" if hdr else "flip"]
            mode = "HDR" if hdr else "LDR"
            # The program adds its mean up in single precision; here the map's is taken in double.
            options = {"inputsRGB": False, "applyMagma": False, "computeMeanError": False}
            error_map = flip_evaluator.evaluate(read(b), read(a), mode, **options)[0]
            theirs = float(error_map.mean(dtype="float64"))
            worst = max(worst, abs(ours - theirs))
            figures = f"{ours:.6f} {theirs:.6f} {ours - theirs:+.1e}"
            print(f"{mode}  {Path(a).name:24} {Path(b).name:20} {figures}", flush=True)
    print(f"largest difference {worst:.1e}, allowed {LARGEST:.0e}")
    sys.exit(worst >= LARGEST)


main()

#!/usr/bin/env python3
"""Two threads of one process beside two processes of one thread each, on figure 5c and in the room with the bunny.

Usage: host/benches/scaling.py [ROUNDS]   after cargo build --release; OCELLUS_DATA names the folder of the bunny.
Prints how much of the two processes' paths per second the two threads reach: median, least and most of the rounds, in
which both take turns. All pictures must be the same.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "ocellus"


def start(scene, threads, samples, picture):
    words = [PROGRAM, "render", scene, "--json", "--threads", str(threads), "--spp", str(samples), "-o", picture]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def finish(process):
    report = json.loads(process.communicate()[0])
    return report["paths"] / report["trace_seconds"], report["image_hash"]


def compare(name, scene, samples, rounds, folder):
    ratios, hashes = [], set()
    for _ in range(rounds):
        together = finish(start(scene, 2, samples, folder / "0.exr"))
        apart = [finish(process) for process in [start(scene, 1, samples, folder / f"{n}.exr") for n in (1, 2)]]
        ratios.append(together[0] / sum(rate for rate, _ in apart))
        hashes |= {together[1], *(image for _, image in apart)}
    if len(hashes) != 1:
        sys.exit(f"{name}: pictures differ")
    print(f"{name:12} {statistics.median(ratios):.3f} ({min(ratios):.3f} to {max(ratios):.3f})")


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        compare("figure 5c", ROOT / "fixtures/report/fig5c.toml", 48, rounds, folder)
        data = os.environ.get("OCELLUS_DATA")
        if not data:
            print("bunny's room: skipped, OCELLUS_DATA names no folder")
            return
        mesh = Path(data).resolve() / "references" / "bunny_in_room.obj"
        scene = folder / "bunny_room.toml"
        text = (ROOT / "fixtures/reference/bunny_room.toml").read_text()
        scene.write_text(f'{text}\n[[meshes]]\nfile = "{mesh}"\nmaterial = "white"\n')
        compare("bunny's room", scene, 256, rounds, folder)


if __name__ == "__main__":
    main()

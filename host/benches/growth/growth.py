"""What rays and paths cost as meshes grow: tables, and a plot.

Rays are those of the peers' bench (one thread, `host/benches/peers/run --growth`). Paths go through the room of
fixtures/reference with a sphere of bumps in it, on one thread and on two. Cost that grows like the logarithm of the number
of triangles is a straight line in the plot.
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
SIZES = [100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000]
SETS = ["primary", "diffuse", "shuffled", "shadow"]
THREADS = [1, 2]
SAMPLES = 64
ROUNDS = 3


def rays(sizes):
    """Nanoseconds of a ray of each set, by size."""
    words = [HERE.parent / "peers" / "run", "--growth", "--triangles", str(sizes[-1]), "--rays", "262144"]
    # No peer has this in its name.
    words += ["--rounds", str(ROUNDS), "--only", "nobody"]
    output = subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout
    print(output)
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in output.splitlines() if "| Ocellus" in line]
    return [[1e3 / float(rate) for rate in line[5:9]] for line in cells]


def write_bumps(file, triangles):
    """A closed sphere of radius 10 with bumps, of about so many triangles, as an OBJ file."""
    rows = max(2, round(0.5 + (triangles / 4 + 0.25) ** 0.5))
    columns = 2 * rows
    latitude = np.linspace(0, np.pi, rows + 1)[1:-1, None]
    longitude = np.linspace(0, 2 * np.pi, columns, endpoint=False)[None, :]
    radius = 10 * np.ones((rows - 1, columns))
    for octave in range(7):
        radius += 0.4 * 0.5**octave * np.sin(latitude * 6 * 2**octave) * np.cos(longitude * 6 * 2**octave)
    sine = np.sin(latitude)
    ring = np.stack([radius * sine * np.cos(longitude), radius * np.cos(latitude), radius * sine * np.sin(longitude)], -1)
    poles = np.array([[0, 10, 0], [0, -10, 0]])
    first = 1 + np.arange((rows - 1) * columns).reshape(rows - 1, columns)
    after = np.roll(first, -1, axis=1)
    quads = [(first[:-1], after[:-1], first[1:]), (after[:-1], after[1:], first[1:])]
    north, south = (np.full(columns, first.size + k) for k in (1, 2))
    caps = [(north, after[0], first[0]), (first[-1], after[-1], south)]
    faces = np.concatenate([np.stack([corner.ravel() for corner in three], -1) for three in quads + caps])
    with open(file, "w") as out:
        np.savetxt(out, np.concatenate([ring.reshape(-1, 3), poles]), "v %.7g %.7g %.7g")
        np.savetxt(out, faces, "f %d %d %d")
    return len(faces)


def paths(program, sizes, folder):
    """Microseconds of a path for each number of threads, by size, and seconds of loading and of set-up."""
    room = (ROOT / "fixtures" / "reference" / "bunny_room.toml").read_text()
    costs = []
    for size in sizes:
        mesh, scene = folder / "bumps.obj", folder / "bumps.toml"
        triangles = write_bumps(mesh, size)
        scene.write_text(f'{room}\n[[meshes]]\nfile = "{mesh}"\nmaterial = "white"\n')
        of_size = []
        for threads in THREADS:
            words = [program, "render", scene, "--json", "--threads", str(threads), "--spp", str(SAMPLES)]
            rounds = []
            for _ in range(ROUNDS):
                report = json.loads(
                    subprocess.run(
                        [*words, "-o", folder / "picture.exr"], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
                    ).stdout
                )
                rounds.append(1e6 * report["trace_seconds"] / report["paths"])
            of_size.append(float(np.median(rounds)))
        print(f"{triangles:>10} triangles: " + ", ".join(f"{cost:.3f} us per path on {t}" for t, cost in zip(THREADS, of_size)))
        costs.append(of_size)
    return costs


def plot(file, sizes, ray_costs, path_costs):
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(9, 3.6), dpi=110)
    for name, costs in zip(SETS, np.transpose(ray_costs)):
        left.plot(sizes, costs, marker="o", markersize=4, label=name)
    left.set(title="One ray query, one thread", ylabel="nanoseconds")
    for threads, costs in zip(THREADS, np.transpose(path_costs)):
        right.plot(sizes, costs, marker="o", markersize=4, label=f"{threads} thread{'s' if threads > 1 else ''}")
    right.set(title="One path of up to 8 segments, in a room", ylabel="microseconds")
    for axes in (left, right):
        axes.set(xscale="log", xlabel="triangles", ylim=(0, None))
        axes.grid(alpha=0.3)
        axes.legend(frameon=False)
    figure.tight_layout()
    figure.savefig(file)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ocellus", required=True, help="the program")
    parser.add_argument("--most", type=int, default=SIZES[-1], help="triangles of the largest mesh")
    parser.add_argument("--plot", default="growth.png")
    arguments = parser.parse_args()
    sizes = [size for size in SIZES if size <= arguments.most]
    ray_costs = rays(sizes)
    with tempfile.TemporaryDirectory() as folder:
        path_costs = paths(arguments.ocellus, sizes, Path(folder))
    for name, costs in [*zip(SETS, np.transpose(ray_costs)), *zip(["path, 1 thread", "path, 2"], np.transpose(path_costs))]:
        # The exponent of a power law through the three largest sizes; that of a logarithm would be near zero.
        exponent = np.polyfit(np.log(sizes[-3:]), np.log(costs[-3:]), 1)[0]
        print(f"{name:15} {costs[-1] / costs[0]:5.2f} times the cost of {sizes[0]} triangles; grows like n^{exponent:.2f} at last")
    plot(arguments.plot, sizes, ray_costs, path_costs)


if __name__ == "__main__":
    main()

"""Renders the rooms of fixtures/reference with Ocellus and with Mitsuba in turn, and compares their speed.

Both trace the same paths: 256 x 256 pixels, box filter, independent samples, at most eight segments, no roulette. Ocellus
renders once more with what makes its pictures quieter: Sobol's numbers, roulette and aim. Times are those of tracing:
loading, building and Mitsuba's compilation are apart. Medians of rounds, each of which renders with every program.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
FIXTURES = HERE.parents[2] / "fixtures" / "reference"
SIZE = 256
# What makes pictures quieter in the same time, and about as many samples as the error asked for then takes: with Sobol's
# numbers errors fall faster than 1 / spp.
QUIET = 'sampler = "sobol"\nroulette_after = 2\naim = true\n'
QUIET_SPP = {"spheres": 256, "bunny_room": 16}
# The error whose time is asked for, and what keeps dark pixels from counting more than others.
RELMSE = 0.01
EPSILON = 0.01

# Centre, radius and albedo.
WALLS = {
    "right": ((1000, 0, 0), 940, (0.9, 0.2, 0.9)),
    "left": ((-1000, 0, 0), 940, (0.6, 0.5, 0.1)),
    "ceiling": ((0, 1000, 0), 940, (0.2, 0.5, 0.9)),
    "floor": ((0, -1000, 0), 990, (0.3, 0.4, 0.7)),
    "back": ((0, 0, 1000), 940, (0.9, 0.4, 0.3)),
    "far": ((0, 0, -1000), 940, (0.4, 0.8, 0.7)),
}


def mitsuba_scene(mi, name, mesh):
    """The scene files' numbers in Mitsuba's words."""

    def sphere(center, radius, **rest):
        return {"type": "sphere", "center": list(center), "radius": radius, **rest}

    def diffuse(albedo):
        return {"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo}}

    radiance = 1e5 / (4 * np.pi**2 * 25)
    light = {"type": "area", "radiance": {"type": "rgb", "value": [radiance] * 3}}
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 8, "rr_depth": 100},
        "sensor": {
            "type": "perspective",
            "fov": 60,
            "fov_axis": "x",
            "to_world": mi.ScalarTransform4f().look_at(origin=[0, 0, 55], target=[0, 0, 0], up=[0, 1, 0]),
            "film": {
                "type": "hdrfilm",
                "width": SIZE,
                "height": SIZE,
                "rfilter": {"type": "box"},
                "pixel_format": "rgb",
                "component_format": "float32",
            },
            "sampler": {"type": "independent"},
        },
        "light": sphere((-10, 25, -10), 5, emitter=light, bsdf=diffuse(0.0)),
    }
    for wall, (center, radius, albedo) in WALLS.items():
        scene[wall] = sphere(center, radius, bsdf=diffuse(list(albedo)))
    if name == "spheres":
        glass = {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}
        mirror = {"type": "conductor", "material": "none"}
        scene["ball"] = sphere((0, 0, 0), 10, bsdf=glass)
        scene["mirror"] = sphere((-20, 0, 0), 10, bsdf=mirror)
        scene["shell"] = sphere((20, 0, 0), 10, bsdf=glass)
        scene["hollow"] = sphere((20, 0, 0), 9.6, flip_normals=True, bsdf=glass)
    else:
        scene["bunny"] = {"type": "obj", "filename": str(mesh), "face_normals": True, "bsdf": diffuse(0.8)}
    return mi.load_dict(scene)


def serve_mitsuba(variant, threads, name, mesh):
    """Renders as often as it is asked: one line of `spp seed file` in, one line of seconds out."""
    import drjit
    import mitsuba as mi

    mi.set_variant(variant)
    drjit.set_thread_count(threads)
    scene = mitsuba_scene(mi, name, mesh)
    np.asarray(mi.render(scene, spp=4, seed=1))
    print("ready", flush=True)
    for line in sys.stdin:
        spp, seed, file = line.split()
        start = time.perf_counter()
        picture = np.asarray(mi.render(scene, spp=int(spp), seed=int(seed)))
        seconds = time.perf_counter() - start
        np.save(file, picture)
        print(seconds, flush=True)


class Mitsuba:
    """A process of its own for each variant, so that each compiles its kernels once."""

    def __init__(self, variant, threads, name, mesh):
        self.name = f"Mitsuba {variant}"
        words = [sys.executable, __file__, "--serve", variant, "--threads", str(threads), "--scene", name]
        words += ["--mesh", str(mesh)] if mesh else []
        self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        if self.process.stdout.readline().strip() != "ready":
            sys.exit(f"{self.name} does not start")

    def render(self, spp, seed, folder):
        file = folder / "mitsuba.npy"
        self.process.stdin.write(f"{spp} {seed} {file}\n")
        self.process.stdin.flush()
        seconds = float(self.process.stdout.readline())
        return seconds, np.load(file)

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Ocellus:
    def __init__(self, name, program, threads, scene):
        self.name = name
        self.words = [program, "render", str(scene), "--json", "--threads", str(threads)]

    def render(self, spp, seed, folder):
        file = folder / "ocellus.exr"
        words = [*self.words, "--spp", str(spp), "--seed", str(seed), "-o", str(file)]
        report = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
        return report["trace_seconds"], read(file)

    def close(self):
        pass


def read(file):
    import mitsuba as mi

    return np.asarray(mi.Bitmap(str(file)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))


def relmse(picture, reference, error):
    """Mean of (x - r)^2 / (r^2 + EPSILON), the reference's own noise subtracted."""
    excess = (picture - reference) ** 2 - error**2
    return float(np.mean(excess / (reference**2 + EPSILON)))


def compare(arguments, name, mesh, references):
    reference, error = (read(references / f"{name}{end}.exr") for end in ("", ".se"))
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        text = (FIXTURES / f"{name}.toml").read_text()
        if mesh:
            text += f'\n[[meshes]]\nfile = "{mesh}"\nmaterial = "white"\n'
        renderers = []
        for title, more in [("Ocellus", ""), ("Ocellus, quiet", QUIET)]:
            scene = folder / f"{name}{len(renderers)}.toml"
            scene.write_text(text.replace("[integrator]\n", f"[integrator]\n{more}"))
            renderers.append(Ocellus(title, arguments.ocellus, arguments.threads, scene))
        renderers += [Mitsuba(variant, arguments.threads, name, mesh) for variant in arguments.variants.split(",")]
        rounds = []
        for seed in range(arguments.rounds):
            figures = []
            for renderer in renderers:
                spp = arguments.spp // 4 if "scalar" in renderer.name else arguments.spp
                spp = QUIET_SPP[name] if "quiet" in renderer.name else spp
                seconds, picture = renderer.render(spp, seed + 1, folder)
                paths = SIZE * SIZE * spp / seconds
                figures.append((paths, spp, relmse(picture, reference, error), picture.mean(axis=(0, 1))))
            rounds.append(figures)
        for renderer in renderers:
            renderer.close()

    print(f"\n{name}: {arguments.rounds} rounds of {arguments.spp} spp, {arguments.threads} threads\n")
    print("| renderer                | k paths/s | ours over it | relMSE x spp | s to relMSE 0.01 | its over ours | mean |")
    print("|-------------------------|-----------|--------------|--------------|------------------|---------------|------|")
    # Error falls as 1/spp, about. Its product with spp is the same for all rounds but for noise, which a mean averages out.
    products = [float(np.mean([figures[k][1] * figures[k][2] for figures in rounds])) for k in range(len(renderers))]
    for k, renderer in enumerate(renderers):
        paths = statistics.median(figures[k][0] for figures in rounds)
        ratio = statistics.median(figures[0][0] / figures[k][0] for figures in rounds)
        seconds = products[k] / RELMSE * SIZE * SIZE / paths
        deviation = np.mean([figures[k][3] for figures in rounds], axis=0) / reference.mean(axis=(0, 1)) - 1
        worst = max(deviation, key=abs)
        slower = products[k] / products[0] * ratio
        print(
            f"| {renderer.name:23} | {paths / 1e3:9.0f} | {ratio:12.2f} | {products[k]:12.3f} | {seconds:16.2f} "
            f"| {slower:13.2f} | {worst:+.2%} |"
        )
        if abs(worst) > 0.005:
            sys.exit(f"{renderer.name}: a channel's mean is {worst:+.2%} off the reference's")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ocellus", help="the program")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--spp", type=int, default=128, help="samples per pixel; scalar variants take a quarter")
    parser.add_argument("--variants", default="llvm_ad_rgb,scalar_rgb", help="of Mitsuba")
    parser.add_argument("--scene", help="only this one")
    parser.add_argument("--serve", help=argparse.SUPPRESS)
    parser.add_argument("--mesh", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.serve:
        serve_mitsuba(arguments.serve, arguments.threads, arguments.scene, arguments.mesh)
        return
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    if arguments.scene in (None, "spheres"):
        compare(arguments, "spheres", None, FIXTURES)
    if arguments.scene in (None, "bunny_room"):
        data = os.environ.get("OCELLUS_DATA")
        if data:
            folder = Path(data).resolve() / "references"
            compare(arguments, "bunny_room", folder / "bunny_in_room.obj", folder)
        else:
            print("skipped: the room with the bunny, since OCELLUS_DATA names no folder")


if __name__ == "__main__":
    main()

"""Times Fissure beside Taichi's Material Point Method on the same block, turn by turn.

    pip install taichi
    cargo build --release
    python pipeline/benchmarks/taichi_block.py [--particles 250000] [--threads 1] [--rounds 5] [--fissure target/release/fissure]
        [--csv docs/charts/taichi.csv]

An elastic square flies and turns, without walls and cracks, so that both do the same: quadratic B-splines, affine PIC, fixed
corotated stress, four particles in a cell, double precision. Taichi runs MLS-MPM (Hu et al. 2018, as in its example mpm99) in the
order of the lattice, which is the best for it; Fissure its total and its updated formulation, this one with the quadratic and the cubic kernel.

Counted is the time of all threads (CPU) and that of a clock, of a long run less that of a short one: compilation, setup and files
fall out. Each round times all once, in turn, so that a machine whose pace changes is the same for all. Printed are medians.
"""

import argparse
import json
import os
import pathlib
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time

YOUNG, POISSON, DENSITY = 1e6, 0.3, 1000.0
SPEED, SPIN = (1.0, 0.5), 1.0
# Steps of the short and of the long run; the total formulation makes ten times as many in that time.
SHORT, LONG = 20, 120
SCENE = """
name = "block"
[[material]]
name = "rubber"
young_modulus = {young}
poisson_ratio = {poisson}
density = {density}
fracture_toughness = 1e9
[[body]]
name = "block"
material = "rubber"
shape = {{ rectangle = {{ min = [0, 0], max = [1, 1] }} }}
velocity = [{speed[0]}, {speed[1]}]
angular_velocity = {spin}
[grid]
particle_spacing = {spacing}
[frames]
range = "1-2"
rate = {rate}
"""
FISSURE = {
    "Fissure, total": ["solver.formulation=total"],
    "Fissure, updated, quadratic APIC": ["solver.formulation=updated", "solver.kernel=quadratic", "solver.transfer=apic"],
    "Fissure, updated, cubic PIC": ["solver.formulation=updated", "solver.kernel=cubic", "solver.transfer=pic"],
}


class TaichiBlock:
    """The block in Taichi."""

    def __init__(self, side, threads):
        import taichi as ti

        ti.init(arch=ti.cpu, default_fp=ti.f64, cpu_max_num_threads=threads, log_level=ti.ERROR)
        self.sync, self.steps = ti.sync, LONG - SHORT
        count, h = side * side, 2.0 / side
        # Cells around the block, so that it stays within the grid.
        margin = 8
        nodes = side // 2 + 2 * margin
        mu, lam = YOUNG / (2 * (1 + POISSON)), YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
        mass, volume = DENSITY / count, 1.0 / count
        self.step_size = step_size = 0.3 * h / ((lam + 2 * mu) / DENSITY) ** 0.5
        x, v = ti.Vector.field(2, float, count), ti.Vector.field(2, float, count)
        affine, deformation = ti.Matrix.field(2, 2, float, count), ti.Matrix.field(2, 2, float, count)
        momentum, node_mass = ti.Vector.field(2, float, (nodes, nodes)), ti.field(float, (nodes, nodes))

        @ti.kernel
        def lay():
            for p in x:
                place = ti.Vector([p % side + 0.5, p // side + 0.5]) / side
                x[p] = place + margin * h
                arm = place - 0.5
                v[p] = ti.Vector([SPEED[0] - SPIN * arm.y, SPEED[1] + SPIN * arm.x])
                affine[p] = ti.Matrix([[0.0, -SPIN], [SPIN, 0.0]])
                deformation[p] = ti.Matrix.identity(float, 2)

        @ti.kernel
        def advance():
            for node in ti.grouped(node_mass):
                node_mass[node] = 0.0
                momentum[node] = ti.Vector.zero(float, 2)
            for p in x:
                base = ti.cast(x[p] / h - 0.5, int)
                fx = x[p] / h - ti.cast(base, float)
                w = [0.5 * (1.5 - fx) ** 2, 0.75 - (fx - 1) ** 2, 0.5 * (fx - 0.5) ** 2]
                deformation[p] = (ti.Matrix.identity(float, 2) + step_size * affine[p]) @ deformation[p]
                f = deformation[p]
                a, b = f[0, 0] + f[1, 1], f[1, 0] - f[0, 1]
                r = ti.sqrt(a * a + b * b)
                rotation = ti.Matrix([[a, -b], [b, a]]) / r
                j = f.determinant()
                kirchhoff = 2 * mu * (f - rotation) @ f.transpose() + ti.Matrix.identity(float, 2) * lam * j * (j - 1)
                sent = -step_size * volume * 4 / (h * h) * kirchhoff + mass * affine[p]
                for i, k in ti.static(ti.ndrange(3, 3)):
                    arm = (ti.Vector([i, k]) - fx) * h
                    weight = w[i].x * w[k].y
                    momentum[base + ti.Vector([i, k])] += weight * (mass * v[p] + sent @ arm)
                    node_mass[base + ti.Vector([i, k])] += weight * mass
            for node in ti.grouped(node_mass):
                if node_mass[node] > 0:
                    momentum[node] /= node_mass[node]
            for p in x:
                base = ti.cast(x[p] / h - 0.5, int)
                fx = x[p] / h - ti.cast(base, float)
                w = [0.5 * (1.5 - fx) ** 2, 0.75 - (fx - 1) ** 2, 0.5 * (fx - 0.5) ** 2]
                velocity, c = ti.Vector.zero(float, 2), ti.Matrix.zero(float, 2, 2)
                for i, k in ti.static(ti.ndrange(3, 3)):
                    weight = w[i].x * w[k].y
                    of_node = momentum[base + ti.Vector([i, k])]
                    velocity += weight * of_node
                    c += 4 / h * weight * of_node.outer_product(ti.Vector([i, k]) - fx)
                v[p], affine[p] = velocity, c
                x[p] += step_size * velocity

        self.lay, self.advance, self.velocities = lay, advance, v
        lay()
        self.run(2)

    def run(self, steps):
        """Times so many steps from the start: seconds of all threads, and of a clock."""
        self.lay()
        self.sync()
        cpu, wall = time.process_time(), time.perf_counter()
        for _ in range(steps):
            self.advance()
        self.sync()
        return time.process_time() - cpu, time.perf_counter() - wall

    def drift(self):
        """How far the mean velocity is from the first, which nothing changes [m/s]."""
        mean = self.velocities.to_numpy().mean(axis=0)
        return max(abs(mean[0] - SPEED[0]), abs(mean[1] - SPEED[1]))


class FissureBlock:
    """The block in Fissure."""

    def __init__(self, program, side, threads, settings, folder):
        self.program, self.threads = program, threads
        self.settings = [argument for setting in settings for argument in ("--set", setting)]
        self.folder = folder
        self.scene = folder / "block.toml"
        values = dict(young=YOUNG, poisson=POISSON, density=DENSITY, speed=SPEED, spin=SPIN, spacing=1 / side, rate=1e3)
        self.scene.write_text(SCENE.format(**values))
        step_size = self.check(1e3)["stable_time_step"]
        # The solver makes its steps a little shorter, so that they divide the frame.
        times = 10 if "solver.formulation=total" in settings else 1
        self.rates = {steps: 1.1 / (times * steps * step_size) for steps in (SHORT, LONG)}
        long, short = (self.check(self.rates[steps])["steps"] for steps in (LONG, SHORT))
        self.steps = long - short

    def check(self, rate):
        """What the program says of the scene with so many frames in a second."""
        command = [self.program, "check", self.scene, "--log", "json", "--set", f"frames.rate={rate}", *self.settings]
        return json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)

    def run(self, steps):
        """Times a whole run of so many steps: seconds of all threads, and of a clock."""
        rate, output = f"frames.rate={self.rates[steps]}", self.folder / "out"
        command = [self.program, "sim", self.scene, "--quiet", "--overwrite", "--output", output, "--set", rate]
        command += ["--set", "take.particles=none", "--threads", str(self.threads), *self.settings]
        before, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        subprocess.run(command, check=True, env={**os.environ, "RAYON_NUM_THREADS": str(self.threads)})
        after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter() - wall
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def main():
    about, usage = __doc__.split("\n\n", 1)
    parser = argparse.ArgumentParser(description=about, epilog=usage, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--particles", type=int, default=250_000)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--fissure", type=pathlib.Path, default=pathlib.Path("target/release/fissure"))
    parser.add_argument("--csv", type=pathlib.Path, help="file to write the table into, too")
    options = parser.parse_args()
    if not options.fissure.is_file():
        sys.exit(f"{options.fissure} is not there: cargo build --release, or name the program with --fissure")
    try:
        import taichi
    except ImportError:
        sys.exit("taichi is not installed: pip install taichi")
    side = 2 * round(options.particles**0.5 / 2)
    with tempfile.TemporaryDirectory() as folder:
        block = TaichiBlock(side, options.threads)
        blocks = {"Taichi, MLS-MPM, quadratic APIC": block}
        for name, settings in FISSURE.items():
            blocks[name] = FissureBlock(options.fissure, side, options.threads, settings, pathlib.Path(folder))
        rates = {name: [] for name in blocks}
        for _ in range(options.rounds):
            for name, block_of in blocks.items():
                short, long = block_of.run(SHORT), block_of.run(LONG)
                rates[name].append([side * side * block_of.steps / (b - a) for a, b in zip(short, long)])
        drift = block.drift()
    version = ".".join(map(str, taichi.__version__))
    head = f"{side * side} particles, {options.threads} threads, f64, Taichi {version}, {platform.processor() or platform.machine()}"
    print(head)
    print(f"mean velocity of Taichi's block off by {drift:.1e} m/s after {LONG} steps\n")
    print("| | M particle-steps/s, CPU | of Taichi | wall | of Taichi |\n|---|---|---|---|---|")
    medians = {name: [statistics.median(column) for column in zip(*rows)] for name, rows in rates.items()}
    of = next(iter(medians.values()))
    for name, (cpu, wall) in medians.items():
        print(f"| {name} | {cpu * 1e-6:.1f} | {cpu / of[0]:.1f} | {wall * 1e-6:.1f} | {wall / of[1]:.1f} |")
    if options.csv:
        rows = [f"{name.replace(',', ';')},{cpu:.4g},{cpu / of[0]:.3g},{wall:.4g},{wall / of[1]:.3g}" for name, (cpu, wall) in medians.items()]
        columns = "program,particle_steps_per_cpu_second,of_taichi_cpu,particle_steps_per_second,of_taichi"
        options.csv.write_text("\n".join([f"# {head.replace(',', ';')}", columns, *rows]) + "\n")


if __name__ == "__main__":
    main()

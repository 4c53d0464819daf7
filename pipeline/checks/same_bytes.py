"""Runs two builds of the program on the same scenes and cases and says where their results differ.

    cargo build --release && cp target/release/fissure before     # at the older commit
    cargo build --release                                         # at the newer one
    python pipeline/checks/same_bytes.py before target/release/fissure

A change that only moves code must leave every frame, table and mesh of the examples as it is, to the last byte, and every
number of the verification. What belongs to one build alone is left out: the solver's saved state (`state.bin`), the list of
files that names the build, and times. `--quick` takes coarse examples and cases (about five minutes); without it everything
runs as it is shown and verified. `--scene FILE` and `--case NAME`, both repeatable, choose some; `--set` reaches all scenes.
Only the standard library is needed.
"""

import argparse
import difflib
import hashlib
import pathlib
import re
import subprocess
import sys
import tempfile

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
COMPARED = {".safetensors", ".csv", ".glb", ".ply"}
# Coarse examples: their own spacing times this.
QUICK_SPACING = 2.0
QUICK_CELLS = "6"


def spacing(scene):
    """Particle spacing that a scene file asks for [m]."""
    return float(re.search(r"^particle_spacing\s*=\s*([0-9.eE+-]+)", scene.read_text(), re.MULTILINE).group(1))


def run(program, arguments):
    """Output of a run, and its exit code: a run that fails is a result like any other."""
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


def digests(folder):
    """SHA-256 of every compared file in a folder, by its path within it."""
    files = sorted(path for path in folder.rglob("*") if path.suffix in COMPARED)
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def compare_scene(programs, scene, overrides):
    """Lines that tell how the files of a scene differ, and the number of files."""
    results = []
    for program in programs:
        with tempfile.TemporaryDirectory() as folder:
            sets = [word for override in overrides for word in ("--set", override)]
            output = ["--formats", "glb,ply", "--quiet", "--output", folder]
            code, _ = run(program, ["run", str(scene), *sets, *output])
            results.append((code, digests(pathlib.Path(folder))))
    (code_before, before), (code_after, after) = results
    lines = [] if code_before == code_after else [f"exit code {code_before} before, {code_after} after"]
    lines += [f"only before: {name}" for name in sorted(before.keys() - after.keys())]
    lines += [f"only after: {name}" for name in sorted(after.keys() - before.keys())]
    lines += [f"differs: {name}" for name in sorted(before.keys() & after.keys()) if before[name] != after[name]]
    return lines, len(after)


def without_times(text):
    """The text of a case without how long it took."""
    return [re.sub(r"[0-9.]+ s with \d+ threads?", "", line) for line in text.splitlines()]


def compare_case(programs, case, cells):
    """Lines that tell how the numbers of a case differ, and how many lines it has."""
    results = [run(program, ["verify", case, "--markdown", *cells]) for program in programs]
    before, after = (without_times(text) for _, text in results)
    lines = [line for line in difflib.unified_diff(before, after, "before", "after", n=0, lineterm="")]
    return lines, len(after)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs=2, metavar="PROGRAM", help="the build before and the build after")
    parser.add_argument("--quick", action="store_true", help="coarse examples and cases")
    parser.add_argument("--scene", action="append", type=pathlib.Path, help="a scene file [default: all examples]")
    parser.add_argument("--case", action="append", help="a case of `verify` [default: all]")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override of every scene")
    chosen = parser.parse_args()
    programs = [str(pathlib.Path(program).resolve()) for program in chosen.programs]
    everything = not chosen.scene and not chosen.case
    scenes = chosen.scene or (sorted(EXAMPLES.glob("*/scene.toml")) if everything else [])
    listed = run(programs[0], ["verify", "--list"])[1].splitlines()
    cases = chosen.case or ([line.split()[0] for line in listed] if everything else [])

    failures = 0
    for scene in scenes:
        coarse = [f"grid.particle_spacing={QUICK_SPACING * spacing(scene)!r}"] if chosen.quick else []
        failures += tell(str(scene.parent.name), *compare_scene(programs, scene, coarse + chosen.set), "files")
    for case in cases:
        cells = ["--cells", QUICK_CELLS] if chosen.quick else []
        failures += tell(case, *compare_case(programs, case, cells), "lines")
    print(f"{len(scenes)} scenes and {len(cases)} cases: {failures} differ")
    sys.exit(failures > 0)


def tell(name, differences, count, what):
    """Prints one comparison; whether it failed. Nothing to compare is a failure too."""
    print(f"{name:<20} {count} {what}: {'same' if count and not differences else 'DIFFERENT'}", flush=True)
    for line in differences[:10]:
        print(f"    {line}")
    if len(differences) > 10:
        print(f"    and {len(differences) - 10} more")
    return not count or bool(differences)


if __name__ == "__main__":
    main()

"""What meshes of examples are like, for each way to cut them: a table.

    pip install numpy safetensors scipy shapely trimesh networkx
    python measure_meshes.py FISSURE TABLE NAME [NAME ...]

Simulates each example with the program FISSURE, makes GLB files of the part `cracked` of all its frames, and writes one
row per example, cut and walls ("plain", or "rough" by a fifth of a cell) into TABLE:

    frames, objects, vertices, triangles   how many, in all frames
    below_20, folded, folded_area          triangles of the front cap with an angle below 20 degrees, of those turned over
                                           how many, and with how much area [m2]
    pairs, same                            objects that are in two frames in a row, and how many of them have the same
                                           triangles in both, so that vertex n is vertex n
    broken_5e_5, broken_1e_4               objects that are not closed once vertices within so much of the body are merged
    overlap                                part of the smaller of two objects of a frame that lies in the other one, at most
    milliseconds                           time of all threads for a frame [ms]; a busy machine makes it longer
"""

import csv
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

import numpy
import shapely
from check_merging import body, is_closed, merged
from check_surfaces import SHARP, cap, cross, triangle_quality, worst_overlap
from glb import Glb

COLUMNS = (
    "example cut walls frames objects vertices triangles below_20 folded folded_area pairs same broken_5e_5 broken_1e_4 overlap milliseconds"
).split()


def seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure(folder):
    files = [path for path in sorted(folder.glob("*.glb")) if path.stem.split(".")[-1].isdigit()]
    row = dict.fromkeys(COLUMNS[3:-1], 0)
    row["frames"], sizes, before = len(files), {}, {}
    for path in files:
        here, regions = {}, []
        for name, _, vertices, faces in Glb(path).objects():
            size = sizes.setdefault(body(name), numpy.ptp(vertices, axis=0).max())
            row["objects"] += 1
            row["vertices"] += len(vertices)
            row["triangles"] += len(faces)
            triangles = cap(vertices, faces)
            row["below_20"] += int((triangle_quality(triangles)[0].min(axis=1) < SHARP).sum())
            areas = cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2
            row["folded"] += int((areas < 0).sum())
            row["folded_area"] -= areas[areas < 0].sum()
            here[name] = faces
            for part, column in ((5e-5, "broken_5e_5"), (1e-4, "broken_1e_4")):
                left, count, _ = merged(vertices, faces, part * size)
                row[column] += not is_closed(left, count)
            regions.append(shapely.union_all(shapely.polygons(triangles)))
        both = here.keys() & before.keys()
        row["pairs"] += len(both)
        row["same"] += sum(numpy.array_equal(here[name], before[name]) for name in both)
        row["overlap"] = max(row["overlap"], worst_overlap(regions))
        before = here
    return row


def main(program, table, names):
    rows = []
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            command = [program, "sim", f"examples/{name}/scene.toml", "--quiet", "--output", str(folder / "run")]
            subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
            for cut, walls in ((cut, walls) for cut in ("opening", "rest") for walls in ("plain", "rough")):
                out = folder / f"{cut}-{walls}"
                command = [program, "post", str(folder / "run"), "--quiet", "--formats", "glb", "--parts", "cracked"]
                command += ["--cut", cut, "--threads", "1", "--output", str(out)]
                if walls == "rough":
                    command += ["--set", f"output.roughness.amplitude={0.2 * cell(folder / 'run')!r}"]
                start = seconds()
                subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
                taken = seconds() - start
                row = {"example": name, "cut": cut, "walls": walls, **measure(out)}
                row["milliseconds"] = f"{1e3 * taken / row['frames']:.1f}"
                row["folded_area"], row["overlap"] = (f"{row[column]:.1e}" for column in ("folded_area", "overlap"))
                rows.append(row)
                print(" ".join(str(row[column]) for column in COLUMNS), flush=True)
    with open(table, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def cell(run):
    """Size of a cell [m]."""
    (manifest,) = run.glob("*.take/manifest.json")
    scene = json.loads(manifest.read_text())["scene"]
    return scene["cell_size"]


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit("usage: measure_meshes.py FISSURE TABLE NAME [NAME ...]")
    main(sys.argv[1], sys.argv[2], sys.argv[3:])

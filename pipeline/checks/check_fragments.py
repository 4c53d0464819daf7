"""Holds the objects of each frame against the fragments of its take.

    pip install numpy safetensors trimesh networkx scipy
    python check_fragments.py OUT/NAME.take OUT

Reads the GLB files of the part `cracked` in OUT. In every frame: one object per fragment of the take, with one name in
all frames; each object watertight by itself, and of the same volume when trimesh merges its vertices as it does by
default; the area of all objects, with what bevels and `output.opening` take off, that of the first frame times the mean det F of all
particles within 1e-3.
"""

import json
import pathlib
import sys

import numpy
import trimesh
from check_solids import check_walls
from glb import Glb
from openings import taken_off
from safetensors.numpy import load_file

AREA = 1e-3
VOLUME = 1e-6


def check_solid(vertices, faces):
    """Problems of one object, and its volume."""
    # trimesh merges within 1e-8, whatever the size: the shortest side becomes 1.
    scale = numpy.ptp(vertices, axis=0).min()
    mesh = trimesh.Trimesh(vertices / scale, faces, process=True)
    problems = [] if mesh.is_watertight and mesh.is_winding_consistent else ["not watertight"]
    merged = mesh.copy()
    merged.merge_vertices()
    if not abs(merged.volume - mesh.volume) <= VOLUME * mesh.volume:
        problems.append(f"{merged.volume / mesh.volume - 1:.1e} of its volume are lost when vertices are merged")
    return problems, mesh.volume * scale**3


def main(take, folder):
    take, folder = pathlib.Path(take), pathlib.Path(folder)
    records = json.loads((folder / "manifest.json").read_text())["files"]
    records = [record for record in records if record["part"] == "cracked" and record["format"] == "glb"]
    if not records:
        sys.exit(f"{folder}: no GLB file of the part `cracked`")
    scene = json.loads((take / "manifest.json").read_text())["scene"]
    names, first, worst, failures = {}, None, 0.0, 0
    for record in records:
        frame = load_file(take / f"frame.{record['frame']:04}.safetensors")
        problems, found, volume = [], [], 0.0
        for name, piece, vertices, faces in Glb(folder / record["file"]).objects():
            wrong, part = check_solid(vertices, faces)
            volume += part + check_walls(vertices, faces, record)[1]
            problems += [f"{name}: {problem}" for problem in wrong]
            found.append(piece)
            if names.setdefault(piece, name) != name:
                problems.append(f"{name} was {names[piece]}")
        fragments = sorted(set(frame["particles.piece"].tolist()))
        if sorted(found) != fragments:
            problems.append(f"objects {sorted(found)}, fragments {fragments}")
        area = (volume / record["thickness"] + taken_off(frame, scene)) / numpy.linalg.det(frame["particles.deformation_gradient"]).mean()
        first = first or area
        worst = max(worst, abs(area / first - 1))
        if abs(area / first - 1) > AREA:
            problems.append(f"area off by {area / first - 1:.1e}")
        for problem in problems:
            print(f"{record['file']}: {problem}", file=sys.stderr)
        failures += bool(problems)
    print(f"{len(records)} frames, {len(names)} fragments, area within {worst:.1e}: {failures} bad")
    sys.exit(failures > 0)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: check_fragments.py TAKE FOLDER")
    main(*sys.argv[1:])

"""Reads mesh files with meshio and trimesh and holds them against their manifest.

    pip install meshio trimesh numpy networkx scipy
    python check_solids.py out/manifest.json ...

Every PLY must be readable by meshio; every object (a node of a GLB file, the vertices of one `piece` of a PLY file) must
be watertight and consistently wound, and all of a file together of volume = area x thickness within 1e-6 relative. trimesh
merges equal vertices for that, of each object by itself, because objects may touch; normals and texture coordinates are
ignored, because hard edges need split vertices.
"""

import json
import pathlib
import sys

import meshio
import numpy
import trimesh
from glb import Glb

SOLID_PARTS = {"cracked", "body", "collider"}
RELATIVE = 1e-6


def solid(vertices, faces):
    """A trimesh scaled so that its shortest side is 1, and the scale: trimesh merges within 1e-8, whatever the size."""
    scale = numpy.ptp(vertices, axis=0).min()
    mesh = trimesh.Trimesh(numpy.asarray(vertices, dtype=numpy.float64) / scale, faces, process=True)
    return mesh, scale


def objects(path):
    """Vertices and faces of each object of a file, nothing merged."""
    if path.suffix == ".ply":
        mesh = meshio.read(path)
        faces = numpy.concatenate([block.data for block in mesh.cells])
        piece = numpy.asarray(mesh.point_data.get("piece", numpy.zeros(len(mesh.points))))
        for number in numpy.unique(piece):
            yield mesh.points, faces[piece[faces[:, 0]] == number]
        return
    for _, _, vertices, faces in Glb(path).objects():
        yield vertices, faces


def check(folder, record):
    """Problems of one file."""
    path = folder / record["file"]
    problems = []
    if record["format"] == "ply":
        by_meshio = meshio.read(path)
        if len(by_meshio.points) != record["vertices"]:
            problems.append(f"meshio reads {len(by_meshio.points)} of {record['vertices']} vertices")
        faces = sum(len(block.data) for block in by_meshio.cells)
        if faces != record["triangles"]:
            problems.append(f"meshio reads {faces} of {record['triangles']} triangles")
    else:
        faces = sum(len(mesh.faces) for mesh in trimesh.load_scene(path, process=False).geometry.values())
        if faces != record["triangles"]:
            problems.append(f"trimesh reads {faces} of {record['triangles']} triangles")
    if record["part"] not in SOLID_PARTS or record["triangles"] == 0:
        return problems
    volume = 0.0
    for number, (vertices, faces) in enumerate(objects(path)):
        mesh, scale = solid(vertices, faces)
        if not mesh.is_watertight:
            problems.append(f"object {number} is not watertight")
        if not mesh.is_winding_consistent:
            problems.append(f"object {number} is not consistently wound")
        volume += mesh.volume * scale**3
    expected = record["area"] * record["thickness"]
    if not abs(volume - expected) <= RELATIVE * expected:
        problems.append(f"volume {volume!r} instead of {expected!r}")
    return problems


def main(manifests):
    if not manifests:
        sys.exit("usage: check_solids.py MANIFEST.json ...")
    files = failures = 0
    for manifest in map(pathlib.Path, manifests):
        for record in json.loads(manifest.read_text())["files"]:
            files += 1
            try:
                problems = check(manifest.parent, record)
            except Exception as problem:  # a reader may fail in any way; all of them count
                problems = [f"{type(problem).__name__}: {problem}"]
            for problem in problems:
                print(f"{record['file']}: {problem}", file=sys.stderr)
            failures += bool(problems)
    print(f"{files} mesh files: {failures} bad")
    sys.exit(failures > 0)


if __name__ == "__main__":
    main(sys.argv[1:])

"""Reads mesh files with meshio and trimesh and holds them against their manifest.

    pip install meshio trimesh numpy networkx scipy
    python check_solids.py out/manifest.json ...

Every PLY must be readable by meshio; every solid must be watertight, consistently wound and of
volume = area x thickness within 1e-6 relative. trimesh merges equal vertices for that; normals and
texture coordinates are ignored (merge_norm, merge_tex), because hard edges need split vertices.
"""

import json
import pathlib
import sys

import meshio
import numpy
import trimesh

SOLID_PARTS = {"cracked", "body", "collider"}
RELATIVE = 1e-6


def solid(vertices, faces):
    """A trimesh scaled so that its shortest side is 1, and the scale: trimesh merges within 1e-8, whatever the size."""
    scale = numpy.ptp(vertices, axis=0).min()
    mesh = trimesh.Trimesh(numpy.asarray(vertices, dtype=numpy.float64) / scale, faces, process=True)
    return mesh, scale


def read(path):
    """Vertices and faces of a file, nothing merged; of a GLB file all nodes and primitives joined."""
    scene = trimesh.load_scene(path, process=False)
    vertices, faces, first = [], [], 0
    for name in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[name]
        mesh = scene.geometry[geometry]
        vertices.append(trimesh.transformations.transform_points(mesh.vertices, transform))
        faces.append(mesh.faces + first)
        first += len(mesh.vertices)
    return numpy.concatenate(vertices), numpy.concatenate(faces)


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
    if record["part"] not in SOLID_PARTS or record["triangles"] == 0:
        return problems
    mesh, scale = solid(*read(path))
    if not mesh.is_watertight:
        problems.append("not watertight")
    if not mesh.is_winding_consistent:
        problems.append("not consistently wound")
    expected = record["area"] * record["thickness"]
    volume = mesh.volume * scale**3
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

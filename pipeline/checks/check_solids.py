"""Reads mesh files with meshio and trimesh and holds them against their manifest.

    pip install meshio trimesh numpy networkx scipy shapely
    python check_solids.py out/manifest.json ...

Every PLY must be readable by meshio; every object (a node of a GLB file, the vertices of one `piece` of a PLY file) must
be watertight and consistently wound, and all of a file together of volume = area x thickness within 1e-6 relative. trimesh
merges equal vertices for that, of each object by itself, because objects may touch; normals and texture coordinates are
ignored, because hard edges need split vertices.

Where the manifest tells of a `bevel` its slopes end within that depth and that far in, but for mitres, and what is missing
is what lies above them. Where it tells of `roughness` no vertex of a wall is farther than that from the edge of the cap
that it stands on, and the volume is off by that times the area of walls at most.
"""

import json
import pathlib
import sys

import meshio
import numpy
import shapely
import trimesh
from glb import Glb

SOLID_PARTS = {"cracked", "body", "collider"}
RELATIVE = 1e-6
# Corners that are bevelled turn by 120 degrees at most: a mitre lies twice the width of the bevel in.
MITRE = 2.0


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


def depths(vertices, thickness):
    """How far below the nearer cap each vertex lies, and its place in the plane: the caps are where most vertices are."""
    half = thickness / 2
    on_caps = (numpy.abs(numpy.abs(vertices) - half) <= RELATIVE * thickness).sum(axis=0)
    axis = on_caps.argmax()
    below = half - numpy.abs(vertices[:, axis])
    below[numpy.abs(below) <= RELATIVE * thickness] = 0
    return below, numpy.delete(vertices, axis, axis=1)


def cap_outline(faces, below, places):
    """The edges of the caps, those in front and at the back, each as a line."""
    caps = faces[(below[faces] == 0).all(axis=1)]
    # Walls whose corners are all on caps are vertical: nothing of them is left in the plane.
    corners = places[caps]
    along, beside = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    flat = numpy.abs(along[:, 0] * beside[:, 1] - along[:, 1] * beside[:, 0]) > 0
    corners = corners[flat]
    edges = numpy.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    # Each edge within a cap is there twice for each cap, one around it once.
    turned = (edges[:, 0, 0] > edges[:, 1, 0]) | ((edges[:, 0, 0] == edges[:, 1, 0]) & (edges[:, 0, 1] > edges[:, 1, 1]))
    ends = numpy.where(turned[:, None, None], edges[:, ::-1], edges)
    unique, times = numpy.unique(ends.reshape(-1, 4), axis=0, return_counts=True)
    return shapely.linestrings(unique[times == 2].reshape(-1, 2, 2))


def above_slopes(faces, below, places):
    """Volume between slopes and the caps above them."""
    corners = places[faces]
    along, beside = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = numpy.abs(along[:, 0] * beside[:, 1] - along[:, 1] * beside[:, 0]) / 2
    return (area * below[faces].mean(axis=1)).sum()


def check_walls(vertices, faces, record):
    """Problems of the walls of one object, what its volume is less than area x thickness, and by how much it may be off."""
    bevel, roughness, thickness = record.get("bevel", 0), record.get("roughness", 0), record["thickness"]
    if not bevel and not roughness:
        return [], 0, 0
    # A PLY file has one list of vertices for all its objects.
    used, faces = numpy.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    below, places = depths(vertices[used], thickness)
    within = below > 0
    outline = cap_outline(faces, below, places)
    room = (MITRE * bevel + roughness) * (1 + RELATIVE) + RELATIVE * thickness
    points = shapely.points(places[within])
    distances = shapely.STRtree(outline).query_nearest(points, return_distance=True, all_matches=False)[1]
    problems = []
    if len(distances) and distances.max() > room:
        problems.append(f"a wall {distances.max()!r} from the edge of its cap, {room!r} at most")
    if bevel and below.max() > bevel * (1 + RELATIVE) + RELATIVE * thickness:
        problems.append(f"a bevel {below.max()!r} deep, of {bevel!r}")
    if roughness:
        return problems, 0, roughness * thickness * shapely.length(outline).sum()
    return problems, above_slopes(faces, below, places), 0


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
    volume = missing = room = 0.0
    for number, (vertices, faces) in enumerate(objects(path)):
        mesh, scale = solid(vertices, faces)
        if not mesh.is_watertight:
            problems.append(f"object {number} is not watertight")
        if not mesh.is_winding_consistent:
            problems.append(f"object {number} is not consistently wound")
        volume += mesh.volume * scale**3
        of_walls, less, off = check_walls(numpy.asarray(vertices, dtype=numpy.float64), faces, record)
        problems += [f"object {number} has {problem}" for problem in of_walls]
        missing, room = missing + less, room + off
    expected = record["area"] * record["thickness"] - missing
    if not abs(volume - expected) <= RELATIVE * expected + room:
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

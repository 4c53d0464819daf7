"""Whether vertices of each object may be merged by distance, as programs do, and leave it closed.

usage: check_merging.py FOLDER DISTANCE

Reads the GLB files of the part `cracked` in FOLDER, one frame each. DISTANCE is a part of the longest side of the
body of each object, as it is first seen, 1e-4 say, or in metres with an m behind it. As Blender's Merge by Distance does, each vertex takes those nearer
to it that have not gone to another one; triangles without three corners go. An edge of what is left must have one
triangle on either side. Needs numpy and scipy; prints objects that break, and how many have anything to merge.
"""

import pathlib
import sys

import numpy
from glb import Glb
from scipy.spatial import cKDTree


def merged(vertices, faces, distance):
    """The triangles by the numbers of places that are left, how many these are, and whether there was anything to merge."""
    places, number = numpy.unique(vertices, axis=0, return_inverse=True)
    faces = number.reshape(-1)[faces]
    near = {}
    for a, b in cKDTree(places).query_pairs(distance, output_type="ndarray"):
        near.setdefault(a, []).append(b)
        near.setdefault(b, []).append(a)
    to = numpy.arange(len(places))
    targets = set()
    for a in sorted(near):
        if to[a] == a:
            gone = [b for b in near[a] if to[b] == b and b not in targets]
            to[gone] = a
            targets.update([a] if gone else [])
    faces = to[faces]
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return faces[whole], len(places), bool(near)


def is_closed(faces, count):
    """Whether each edge is passed once in each direction."""
    edges = numpy.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(numpy.int64)
    forth, times = numpy.unique(edges[:, 0] * count + edges[:, 1], return_counts=True)
    back = edges[:, 1] * count + edges[:, 0]
    return bool((times == 1).all() and numpy.isin(back, forth).all())


def body(name):
    """The body of an object by its name."""
    return name.rpartition("_piece_")[0]


def main(folder, distance):
    files = [path for path in sorted(pathlib.Path(folder).glob("*.glb")) if path.stem.split(".")[-1].isdigit()]
    files = [path for path in files if "_" not in path.stem.split(".")[0]]
    if not files:
        sys.exit(f"{folder}: no GLB file of the part `cracked`")
    sizes, objects, touched, broken = {}, 0, 0, 0
    for path in files:
        for name, _, vertices, faces in Glb(path).objects():
            size = sizes.setdefault(body(name), numpy.ptp(vertices, axis=0).max())
            within = float(distance[:-1]) if distance.endswith("m") else float(distance) * size
            left, count, has_merged = merged(vertices, faces, within)
            objects, touched = objects + 1, touched + has_merged
            if not is_closed(left, count):
                broken += 1
                print(f"{path.name}: {name} is not closed when vertices are merged", file=sys.stderr)
    print(f"{len(files)} files, {objects} objects, {touched} with vertices to merge within {distance}: {broken} bad")
    sys.exit(broken > 0)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: check_merging.py FOLDER DISTANCE")
    main(*sys.argv[1:])

"""Whether the objects of each frame lie beside each other and not in each other.

usage: check_overlap.py FOLDER

Reads the PLY files of the part `cracked` in FOLDER. An object is what has one number of a fragment. Two objects may have
at most 1e-4 of the area of the smaller one in common. Needs numpy and shapely; prints the worst pair of each file that
is worse, and of all.
"""

import itertools
import pathlib
import sys

import numpy
import shapely

MOST = 1e-4
KINDS = {"float": "<f4", "float32": "<f4", "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4", "uchar": "u1", "uint8": "u1"}


def read(path):
    """The vertices of a binary PLY file as a table, and its triangles."""
    data = path.read_bytes()
    head, _, body = data.partition(b"end_header\n")
    names, kinds, counts, element = [], [], {}, None
    faces = []
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            element = words[1]
            counts[element] = int(words[2])
        elif words[0] == "property" and element == "vertex":
            kinds.append((words[2], KINDS[words[1]]))
        elif words[0] == "property" and element == "face":
            faces.append(words[1:])
    table = numpy.dtype(kinds)
    vertices = numpy.frombuffer(body, table, counts.get("vertex", 0))
    (_, count, index, _), = faces
    face = numpy.dtype([("count", KINDS[count]), ("index", KINDS[index], 3)])
    triangles = numpy.frombuffer(body, face, counts.get("face", 0), vertices.nbytes)["index"]
    return vertices, triangles


def objects(path):
    """The areas of the objects in a file: the union of the triangles of their upper caps."""
    vertices, triangles = read(path)
    if len(triangles) == 0:
        return {}
    places = numpy.stack([vertices[axis].astype(float) for axis in "xyz"], axis=1)
    # z or y points up; the thickness lies along the other one.
    normals = numpy.stack([vertices[axis].astype(float) for axis in ("nx", "ny", "nz")], axis=1)
    through = 1 if spread(places[:, 1]) else 2
    across = [axis for axis in range(3) if axis != through]
    top = places[:, through].max()
    found = {}
    for triangle in triangles:
        if (places[triangle, through] == top).all() and (numpy.abs(normals[triangle, through]) > 0.99).all():
            piece = int(vertices["piece"][triangle[0]])
            found.setdefault(piece, []).append(shapely.Polygon(places[triangle][:, across]))
    return {piece: shapely.union_all(parts) for piece, parts in found.items()}


def spread(values):
    """Whether values have just two sizes, as those along the thickness do."""
    return len(numpy.unique(values)) == 2


def worst_of(path):
    """(part in common, the two objects) of the worst pair of a file."""
    worst = (0.0, None)
    for (a, first), (b, second) in itertools.combinations(objects(path).items(), 2):
        if first.intersects(second):
            part = first.intersection(second).area / min(first.area, second.area)
            worst = max(worst, (part, (a, b)), key=lambda found: found[0])
    return worst


def main():
    folder = pathlib.Path(sys.argv[1])
    files = [path for path in sorted(folder.glob("*.ply")) if "_" not in path.stem.split(".")[0]]
    if not files:
        sys.exit(f"{folder}: no PLY file of the part `cracked`")
    found = [(worst_of(path), path) for path in files]
    for (part, pair), path in found:
        if part > MOST:
            print(f"{path.name}: objects {pair[0]} and {pair[1]} have {part:.2e} of the smaller one in common")
    (part, pair), path = max(found, key=lambda item: item[0][0])
    print(f"{len(files)} files; at most {part:.2e} in common" + (f", objects {pair} in {path.name}" if pair else ""))
    sys.exit(part > MOST)


if __name__ == "__main__":
    main()

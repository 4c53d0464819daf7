"""How good the surfaces of runs are: the worst of each run, in one table.

    pip install numpy safetensors scipy shapely trimesh networkx
    python check_surfaces.py TAKE FOLDER [TAKE FOLDER ...]

Reads the GLB files of the part `cracked` in each FOLDER, made from TAKE. One row per run, of all its frames:

    angle     smallest angle of a triangle of a cap [degrees], and the share of such triangles below 20 degrees
    needle    longest edge over height of a triangle of a cap
    edge      shortest edge of a cap over the size of the body
    chord     how far the outline lies within the curve through its corners that turn by less than 20 degrees, at most,
              in the first frame, over the size of the body
    turn      sharpest of these corners [degrees]
    flips     part of the segments of crack walls whose corners turn in opposite directions, by more than 2 degrees
    volume    |volume and what bevels take off / (area x thickness) - 1|, less what roughness may change
    area      |area of all objects and what `output.opening` takes off / (area in the first frame x mean det F) - 1|
    overlap   part of the smaller of two objects of a frame that lies in the other one
    open      objects that are not watertight, by themselves or when trimesh merges their vertices, or whose walls stand
              elsewhere than bevel and roughness allow
    merged    objects that are not when all vertices nearer than 1e-4 of the size of the body are merged

Fails where a solid is open, also once vertices are merged, a volume is off by more than 1e-6, an area by more than 1e-3, or
where two objects have more than 1e-4 of the smaller one in common.
"""

import json
import pathlib
import sys

import numpy
import scipy.sparse.csgraph
import scipy.spatial
import shapely
from check_fragments import AREA, VOLUME, check_solid
from check_overlap import MOST as OVERLAP
from check_solids import check_walls
from glb import Glb
from openings import taken_off
from safetensors.numpy import load_file

SHARP = 20.0
# Vertices nearer than this part of the body are merged.
NEAR = 1e-4
# A corner that turns by less is straight for the eye.
STRAIGHT = 2.0
COLUMNS = ("angle", "below 20", "needle", "edge", "chord", "turn", "flips", "volume", "area", "overlap", "open", "merged")


def cap(vertices, faces):
    """The triangles of the front cap in the plane, as an array (n, 3, 2)."""
    front = vertices[:, 2].max()
    return vertices[faces[(vertices[faces][:, :, 2] == front).all(axis=1)]][:, :, :2]


def triangle_quality(triangles):
    """Angles [degrees] (n, 3), longest edge over height (n), lengths of edges (n, 3)."""
    edges = numpy.roll(triangles, -1, axis=1) - triangles
    lengths = numpy.linalg.norm(edges, axis=2)
    twice_area = numpy.abs(cross(edges[:, 0], edges[:, 1]))
    sides = edges / lengths[:, :, None]
    cosines = -(sides * numpy.roll(sides, 1, axis=1)).sum(axis=2)
    needle = lengths.max(axis=1) ** 2 / twice_area
    return numpy.degrees(numpy.arccos(cosines.clip(-1, 1))), needle, lengths


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def contours(triangles):
    """The closed contours that triangles leave, each an array (n, 2), material on the left."""
    corners = [list(map(tuple, triangle)) for triangle in triangles]
    edges = {(p[k], p[(k + 1) % 3]) for p in corners for k in range(3)}
    following = {a: b for a, b in edges if (b, a) not in edges}
    while following:
        start = point = next(iter(following))
        contour = []
        while point in following:
            contour.append(point)
            point = following.pop(point)
        if point == start:
            yield numpy.array(contour)


def turns(contour):
    """Turn at each corner [degrees], length of the edge after it."""
    edges = numpy.roll(contour, -1, axis=0) - contour
    before = numpy.roll(edges, 1, axis=0)
    turn = numpy.degrees(numpy.arctan2(cross(before, edges), (before * edges).sum(axis=1)))
    return turn, numpy.linalg.norm(edges, axis=1)


def chord(contour):
    """Height of the arcs over the edges between two gentle corners, at most, and the sharpest of these corners."""
    # Points on straight edges are no corners.
    contour = contour[numpy.abs(turns(contour)[0]) > 0.05]
    if len(contour) < 3:
        return 0.0, 0.0
    turn, length = turns(contour)
    gentle = numpy.abs(turn) < SHARP
    both = gentle & numpy.roll(gentle, -1)
    # The tangents of the arc over an edge turn by half the turns of both its corners.
    between = numpy.radians((turn + numpy.roll(turn, -1)) / 2)
    height = numpy.abs(length * numpy.tan(between / 4) / 2)
    return (height[both].max(), numpy.abs(turn[both]).max()) if both.any() else (0.0, 0.0)


def flips(walls):
    """Edges of crack walls, and how many of them turn one way at their start and the other way at their end."""
    edges = walls[:, 1] - walls[:, 0]
    after = {tuple(wall[0]): number for number, wall in enumerate(walls)}
    turn = {}
    for number, wall in enumerate(walls):
        following = after.get(tuple(wall[1]))
        if following is not None:
            a, b = edges[number], edges[following]
            turn[number] = numpy.degrees(numpy.arctan2(cross(a, b), a @ b))
    found = 0
    for number, wall in enumerate(walls):
        following = after.get(tuple(wall[1]))
        if number in turn and following in turn:
            p, q = turn[number], turn[following]
            found += p * q < 0 and min(abs(p), abs(q)) > STRAIGHT and max(abs(p), abs(q)) < 90
    return len(walls), found


def wall_edges(vertices, faces):
    """The edges of walls on the front, material on their left."""
    front = vertices[:, 2].max()
    on_front = vertices[faces][:, :, 2] == front
    two = on_front.sum(axis=1) == 2
    found = []
    for triangle, there in zip(faces[two], on_front[two]):
        first = [k for k in range(3) if there[k] and there[(k + 1) % 3]][0]
        # Seen from the wall the front edge runs the other way.
        found.append([vertices[triangle[(first + 1) % 3]][:2], vertices[triangle[first]][:2]])
    return numpy.array(found).reshape(-1, 2, 2)


def is_open(vertices, faces, distance):
    """Whether a solid is not closed and manifold any more when vertices nearer than `distance` are merged."""
    pairs = scipy.spatial.cKDTree(vertices).query_pairs(distance, output_type="ndarray")
    count = len(vertices)
    near = scipy.sparse.coo_matrix((numpy.ones(len(pairs)), pairs.T), shape=(count, count))
    merged = scipy.sparse.csgraph.connected_components(near, directed=False)[1][faces].astype(numpy.int64)
    merged = merged[(merged != numpy.roll(merged, 1, axis=1)).all(axis=1)]
    ends = numpy.concatenate([merged[:, [0, 1]], merged[:, [1, 2]], merged[:, [2, 0]]])
    edges, times = numpy.unique(ends[:, 0] * count + ends[:, 1], return_counts=True)
    return (times > 1).any() or not numpy.isin(ends[:, 1] * count + ends[:, 0], edges).all()


def worst_overlap(areas):
    """Part of the smaller one that two of some regions have in common, at most."""
    tree = shapely.STRtree(areas)
    worst = 0.0
    for a, b in tree.query(areas, predicate="intersects").T:
        if a < b:
            common = areas[a].intersection(areas[b]).area
            worst = max(worst, common / min(areas[a].area, areas[b].area))
    return worst


def measure(take, folder):
    """One value for each of COLUMNS."""
    records = json.loads((folder / "manifest.json").read_text())["files"]
    records = [record for record in records if record["part"] == "cracked" and record["format"] == "glb"]
    if not records:
        sys.exit(f"{folder}: no GLB file of the part `cracked`")
    low = {"angle": 180.0, "edge": numpy.inf}
    high = dict.fromkeys(("needle", "chord", "turn", "volume", "area", "overlap"), 0.0)
    below = triangles_seen = segments = flipped = opened = merged = 0
    first, size = None, 1.0
    scene = json.loads((take / "manifest.json").read_text())["scene"]
    for record in records:
        glb = Glb(folder / record["file"])
        regions, volume, room = [], 0.0, 0.0
        for name, piece, vertices, faces in glb.objects():
            triangles = cap(vertices, faces)
            size = size if first else max(size if regions else 0.0, numpy.ptp(vertices[:, :2], axis=0).max())
            angles, needles, lengths = triangle_quality(triangles)
            below += (angles.min(axis=1) < SHARP).sum()
            triangles_seen += len(triangles)
            low["angle"] = min(low["angle"], angles.min())
            low["edge"] = min(low["edge"], lengths.min() / size)
            high["needle"] = max(high["needle"], needles.max())
            if first is None:
                for contour in contours(triangles):
                    height, turn = chord(contour)
                    high["chord"], high["turn"] = max(high["chord"], height / size), max(high["turn"], turn)
            problems, part = check_solid(vertices, faces)
            opened += bool(problems)
            merged += is_open(vertices, faces, NEAR * size)
            wrong, less, off = check_walls(vertices, faces, record)
            opened += bool(wrong)
            volume, room = volume + part + less, room + off
            regions.append(shapely.union_all(shapely.polygons(triangles)))
        for vertices, faces in inside(glb):
            seen, found = flips(wall_edges(vertices, faces))
            segments, flipped = segments + seen, flipped + found
        expected = record["area"] * record["thickness"]
        high["volume"] = max(high["volume"], (abs(volume - expected) - room) / expected)
        frame = load_file(take / f"frame.{record['frame']:04}.safetensors")
        area = (record["area"] + taken_off(frame, scene)) / numpy.linalg.det(frame["particles.deformation_gradient"]).mean()
        first = first or area
        high["area"] = max(high["area"], abs(area / first - 1))
        high["overlap"] = max(high["overlap"], worst_overlap(regions))
    flipped = flipped / segments if segments else 0.0
    counts = {"below 20": below / triangles_seen, "flips": flipped, "open": opened, "merged": merged}
    return {**low, **high, **counts}


def inside(glb):
    """Vertices and triangles of the crack walls of each object."""
    names = [material["name"] for material in glb.document.get("materials", [])]
    for mesh in glb.document.get("meshes", []):
        for primitive in mesh["primitives"]:
            if names[primitive["material"]] == "inside":
                vertices = glb.table(primitive["attributes"]["POSITION"]).astype(float)
                yield vertices, glb.table(primitive["indices"]).reshape(-1, 3).astype(int)


def main(arguments):
    print(f"{'':16}" + "".join(f"{column:>10}" for column in COLUMNS))
    failed = False
    for take, folder in zip(*[iter(map(pathlib.Path, arguments))] * 2):
        found = measure(take, folder)
        print(f"{folder.name[:15]:16}" + "".join(f"{found[column]:10.2g}" for column in COLUMNS), flush=True)
        failed |= found["open"] > 0 or found["merged"] > 0 or found["volume"] > VOLUME or found["area"] > AREA or found["overlap"] > OVERLAP
    sys.exit(bool(failed))


if __name__ == "__main__":
    if len(sys.argv) < 3 or len(sys.argv) % 2 == 0:
        sys.exit("usage: check_surfaces.py TAKE FOLDER [TAKE FOLDER ...]")
    main(sys.argv[1:])

"""The fragments of a frame of a take: the closed walks along its rings and cracks with the material on the left."""

import numpy
import shapely

# Lines nearer than this part of the body are one where they meet.
SAME = 1e-8


class Side:
    """One side of a straight piece of a line: a ring, or a face of a crack."""

    def __init__(self, line, is_crack, rest, points, ends):
        # What moves as one, whether it may open, the two ends at rest, which points of a crack they are, and where they are.
        self.line, self.is_crack, self.rest, self.points, self.ends = line, is_crack, rest, points, ends

    def part(self, place):
        """How far along it a place at rest is."""
        way = self.rest[1] - self.rest[0]
        return float(numpy.clip((place - self.rest[0]) @ way / (way @ way), 0, 1))


class Edge:
    """Part of a side, from one corner of a walk to the next."""

    def __init__(self, side, start, end):
        self.side, self.corners = side, (start, end)
        self.parts = [side.part(numpy.array(corner)) for corner in self.corners]

    def at(self, end, values):
        """What is given at both ends of its side, at its own start (0) or end (1)."""
        return values[0] + self.parts[end] * (values[1] - values[0])

    def is_end(self, end):
        """Whether there it ends where its side does."""
        return self.parts[end] in (0.0, 1.0)


def fragments(frame):
    """The walks around each fragment of a frame: the first from outside, then those of holes and cracks within."""
    found = []
    for body in numpy.unique(frame["outlines.body"]):
        pieces = [*rings(frame, body), *cracks(frame, body)]
        found += group(walks(pieces))
    return found


def chunks(frame, kind, names, body):
    offset = frame[f"{kind}.offset"]
    for number, (begin, end) in enumerate(zip(offset[:-1], offset[1:])):
        if frame[f"{kind}.body"][number] == body:
            yield number, *(frame[f"{kind}.{name}"][begin:end] for name in names)


def rings(frame, body):
    """Pieces of the outline as pairs of sides; there is nothing on its right."""
    for number, rest, position in chunks(frame, "outlines", ("rest", "position"), body):
        for i in range(len(rest)):
            pair = [i, (i + 1) % len(rest)]
            yield Side(("ring", number), False, rest[pair], None, position[pair]), None


def cracks(frame, body):
    for number, rest, above, below in chunks(frame, "cracks", ("rest", "above", "below"), body):
        for i in range(len(rest) - 1):
            pair, back = [i, i + 1], [i + 1, i]
            left = Side(("above", number), True, rest[pair], pair, above[pair])
            yield left, Side(("below", number), True, rest[back], back, below[back])


def walks(pieces):
    """All closed walks along some pieces that have material on their left throughout."""
    pieces = [piece for piece in pieces if (piece[0].rest[0] != piece[0].rest[1]).any()]
    lines = [shapely.LineString(left.rest) for left, _ in pieces]
    size = numpy.ptp(shapely.total_bounds(lines).reshape(2, 2), axis=0).max()
    parts = shapely.get_parts(shapely.union_all(lines, grid_size=SAME * size))
    ends = [list(map(tuple, shapely.get_coordinates(part))) for part in parts]
    ends = [pair for corners in ends for pair in zip(corners[:-1], corners[1:])]
    middles = shapely.points([numpy.add(a, b) / 2 for a, b in ends])
    edges, around = {}, {}
    for (a, b), number in zip(ends, shapely.STRtree(lines).query_nearest(middles, all_matches=False)[1]):
        left, right = pieces[number]
        if numpy.subtract(b, a) @ (left.rest[1] - left.rest[0]) < 0:
            left, right = right, left
        edges[a, b] = left and Edge(left, a, b)
        edges[b, a] = right and Edge(right, b, a)
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    following = {}
    for place, others in around.items():
        others.sort(key=lambda other: numpy.arctan2(other[1] - place[1], other[0] - place[0]))
        for before, other in zip([others[-1], *others[:-1]], others):
            following[other, place] = (place, before)
    while following:
        start, at = next(iter(following.items()))
        walk = [start]
        del following[start]
        while at != start:
            walk.append(at)
            at = following.pop(at)
        if all(edges[step] for step in walk):
            yield [edges[step] for step in walk]


def group(walks):
    """Walks around fragments from outside, each with those that lie within it."""
    walks = [(walk, shapely.Polygon([edge.corners[0] for edge in walk]) if len(walk) > 2 else None) for walk in walks]
    is_outer = lambda area: area is not None and area.area > 0 and shapely.is_ccw(shapely.get_exterior_ring(area))
    outer = sorted(((walk, area) for walk, area in walks if is_outer(area)), key=lambda found: found[1].area)
    found = [[walk] for walk, _ in outer]
    areas = [shapely.make_valid(area) for _, area in outer]
    for walk, area in walks:
        if not is_outer(area):
            middle = shapely.Point(numpy.add(*walk[0].corners) / 2)
            around = [i for i, area in enumerate(areas) if area.contains(middle)]
            if around:
                found[around[0]].append(walk)
    return found


def enclosed(contours):
    """The area that closed lines run around more often to their left than to their right."""
    contours = [numpy.array(contour) for contour in contours]
    starts = numpy.concatenate(contours)
    ends = numpy.concatenate([numpy.roll(contour, -1, axis=0) for contour in contours])
    cells = shapely.get_parts(shapely.polygonize([shapely.union_all(shapely.linestrings(numpy.stack([starts, ends], axis=1)))]))
    if len(cells) == 0:
        return shapely.Polygon()
    places = shapely.get_coordinates(shapely.point_on_surface(cells))
    (ax, ay), (bx, by) = starts.T[:, :, None], ends.T[:, :, None]
    x, y = places.T
    left = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
    times = ((left > 0) & (ay <= y) & (y < by)).sum(axis=0) - ((left < 0) & (by <= y) & (y < ay)).sum(axis=0)
    return shapely.union_all(cells[times > 0])

"""The area that a take's cracks lose to the opening that its scene asks for."""

import numpy
from regions import enclosed, fragments

# Faces farther apart than this many cells are moved no farther.
REACH = 2.0
# What a crack ends on where it ends on nothing.
TIP = -1
# Sine of the angle below which two faces that meet are one line.
STRAIGHT = 0.35


def normals(face):
    """Unit normals of a face, to the left of the way along it."""
    last = len(face) - 1
    number = numpy.arange(len(face))
    along = face[numpy.minimum(number + 1, last)] - face[numpy.maximum(number - 1, 0)]
    length = numpy.linalg.norm(along, axis=1, keepdims=True)
    return numpy.stack([-along[:, 1], along[:, 0]], axis=1) / numpy.where(length == 0, 1, length)


def shifts(frame, opening, factor, reach):
    """How far the face above each crack moves at each of its points; that below moves by the opposite."""
    begins = frame["cracks.offset"]
    for (begin, end), (start_on, end_on) in zip(zip(begins[:-1], begins[1:]), frame["cracks.ends"]):
        above, below, rest = (frame[f"cracks.{name}"][begin:end] for name in ("above", "below", "rest"))
        arc = numpy.concatenate([[0], numpy.cumsum(numpy.linalg.norm(numpy.diff(rest, axis=0), axis=1))])
        way = numpy.minimum(arc if start_on == TIP else numpy.inf, arc[-1] - arc if end_on == TIP else numpy.inf)
        near_tip = numpy.sqrt(numpy.clip(way / opening["falloff"], 0, 1)) if opening["falloff"] else numpy.sign(way)
        across = normals(above) + normals(below)
        across /= numpy.maximum(numpy.linalg.norm(across, axis=1, keepdims=True), 1e-12)
        width = ((above - below) * across).sum(axis=1)
        shown = numpy.maximum(width, opening["least"] * near_tip)
        change = numpy.where(near_tip == 0, 0, shown - width + (factor - 1) * numpy.clip(shown, 0, reach))
        yield 0.5 * change[:, None] * across


def both(a, b):
    """How far a corner moves between faces that move by `a` and `b`: to where both meet, by the mean if they are one line."""
    if not a.any() or not b.any():
        return a + b
    sine = (a[0] * b[1] - a[1] * b[0]) / (numpy.linalg.norm(a) * numpy.linalg.norm(b))
    if abs(sine) < STRAIGHT:
        return (a + b) / 2
    return numpy.linalg.solve([a, b], [a @ a, b @ b])


def corners(walk, moves):
    """The corners of a walk as they are, and as they are shown."""
    still, shown = [], []
    for before, after in zip([walk[-1], *walk[:-1]], walk):
        there, here = before.at(1, before.side.ends), after.at(0, after.side.ends)
        moved = [edge.at(end, moves(edge.side)) for edge, end in ((before, 1), (after, 0))]
        is_one = before.side.line[1] == after.side.line[1] and before.side.is_crack == after.side.is_crack
        if is_one:
            place, move = (there + here) / 2, (moved[0] + moved[1]) / 2
        elif after.side.is_crack and after.is_end(0):
            place, move = here, both(*moved)
        elif before.side.is_crack and before.is_end(1):
            place, move = there, both(*moved)
        else:
            place, move = (there + here) / 2, both(*moved)
        still.append(place)
        shown.append(place + move)
    return still, shown


def taken_off(frame, scene):
    """Area of the body that `output.opening` of a take's `scene` takes off in one of its frames [m²].

    As docs/formats.md tells of it: a crack is open by `least` at least, towards its tips less by the root of the way to
    them over `falloff`, and all of it times the factor. Each fragment is what its moved faces enclose, corners between two
    faces moved with both, and with a factor of 1 or more within what it is without. Paths are taken as they were simulated: meshes
    whose paths are smoothed differ where openings are wider than their bends; with `output.smoothing = 0` they do not.
    """
    opening = scene["output"]["opening"]
    if opening is None:
        return 0.0
    times, factors = numpy.array(opening["factor"]["points"], dtype=float).T
    factor = numpy.interp(frame["frame.time"][0], times, factors)
    reach = max(REACH * scene["cell_size"], opening["least"])
    of_crack = list(shifts(frame, opening, factor, reach))

    def moves(side):
        if not side.is_crack:
            return numpy.zeros((2, 2))
        kind, number = side.line
        return of_crack[number][side.points] * (1 if kind == "above" else -1)

    area = 0.0
    for walks in fragments(frame):
        still, shown = zip(*(corners(walk, moves) for walk in walks))
        still, shown = enclosed(still), enclosed(shown)
        area += still.area - (shown.intersection(still) if factor >= 1 else shown).area
    return area

"""The area that a take's cracks lose to the opening that its scene asks for."""

import numpy

# Faces farther apart than this many cells are moved no farther.
REACH = 2.0
# What a crack ends on where it ends on nothing.
TIP = -1


def normals(face):
    """Unit normals of a face, to the left of the way along it."""
    last = len(face) - 1
    number = numpy.arange(len(face))
    along = face[numpy.minimum(number + 1, last)] - face[numpy.maximum(number - 1, 0)]
    length = numpy.linalg.norm(along, axis=1, keepdims=True)
    return numpy.stack([-along[:, 1], along[:, 0]], axis=1) / numpy.where(length == 0, 1, length)


def taken_off(frame, scene):
    """Area that `output.opening` of a take's `scene` takes off in one of its frames, of all cracks [m²].

    As docs/formats.md tells of it: a crack is open by `least` at least, towards its tips less by the root of the way to
    them over `falloff`, and all of it times the factor. Where cracks meet each other or an outline their openings have a
    little in common.
    """
    opening = scene["output"]["opening"]
    if opening is None:
        return 0.0
    times, factors = numpy.array(opening["factor"]["points"], dtype=float).T
    factor = numpy.interp(frame["frame.time"][0], times, factors)
    reach = max(REACH * scene["cell_size"], opening["least"])
    area = 0.0
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
        length = numpy.linalg.norm(numpy.diff((above + below) / 2, axis=0), axis=1)
        area += (length * (change[1:] + change[:-1]) / 2).sum()
    return area

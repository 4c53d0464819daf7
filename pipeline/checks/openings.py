"""The area that a take's cracks lose to the opening that its scene asks for."""

import numpy
import shapely

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


def strip(near, far, chosen):
    """The places between two lines at the chosen ones of their segments; what overlaps counts once."""
    quads = numpy.stack([near[:-1], near[1:], far[1:], far[:-1]], axis=1)[chosen]
    parts = shapely.make_valid(shapely.polygons(quads)) if len(quads) else []
    return shapely.union_all(parts)


def taken_off(frame, scene):
    """Area of the body that `output.opening` of a take's `scene` takes off in one of its frames [m²].

    As docs/formats.md tells of it: a crack is open by `least` at least, towards its tips less by the root of the way to
    them over `falloff`, and all of it times the factor. What openings have in common counts once, and what was
    open before not at all. Faces may only move into their own fragments: where a fragment is narrower than that, too much is told.
    """
    opening = scene["output"]["opening"]
    if opening is None:
        return 0.0
    times, factors = numpy.array(opening["factor"]["points"], dtype=float).T
    factor = numpy.interp(frame["frame.time"][0], times, factors)
    reach = max(REACH * scene["cell_size"], opening["least"])
    wider, narrower, gaps = [], [], []
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
        apart = 0.5 * change[:, None] * across
        grows = change[1:] + change[:-1] > 0
        for face, sign in ((above, 1), (below, -1)):
            wider.append(strip(face, face + sign * apart, grows))
            narrower.append(strip(face, face + sign * apart, ~grows))
        # Farther apart there may be anything between faces.
        near = numpy.abs(width) < reach
        gaps.append(strip(above, below, near[1:] & near[:-1] & (width[1:] + width[:-1] > 0)))
    wider = shapely.union_all(wider).difference(shapely.union_all(gaps))
    return wider.area - shapely.union_all(narrower).area

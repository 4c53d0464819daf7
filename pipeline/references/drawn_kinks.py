#!/usr/bin/env python3
"""Stress intensities at the tip of a kinked edge crack, by finite elements.

The plate of the case `drawn-kinks` (crates/verify): a square of side 1 under tension 1 on its upper and lower edges, an edge crack from the middle of the
left edge, 1/3 long, with a straight branch at its end, turned by an angle from it; plane strain, nu = 0.3 (with tractions only, K depends on neither).
Quadratic triangles on a Delaunay mesh graded geometrically towards the tip and the kink; K by the interaction integral within the straight branch.

    python3 pipeline/references/drawn_kinks.py [fineness]

Needs numpy and scipy. Prints K_I and K_II over sigma sqrt(pi a), a = 1/3, for branches given in 48ths of the side. Halving the elements changes them by
less than 0.05 %.
"""

import sys

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve
from scipy.spatial import Delaunay

POISSON = 0.3
YOUNG = 1.0
MU = YOUNG / 2 / (1 + POISSON)
LAMBDA = YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON)
KOLOSOV = 3 - 4 * POISSON
MODULUS = YOUNG / (1 - POISSON**2)
PARENT = 1 / 3


def distance_to(points, a, b):
    t = np.clip(((points - a) @ (b - a)) / ((b - a) @ (b - a)), 0, 1)
    return np.hypot(*(points - a - t[:, None] * (b - a)).T)


def mesh(line, smallest, fineness, height=1):
    """Nodes and triangles of a plate of width 1; along the line points so close that its pieces are edges."""
    tip, kink = line[-1], line[-2]

    def size(p):
        to_tip, to_kink = np.hypot(*(p - tip).T), np.hypot(*(p - kink).T)
        of_tip = np.maximum(0.3 * to_tip, 1e-4 * smallest)
        of_kink = np.maximum(0.3 * to_kink, 1e-3 * smallest) if len(line) > 2 else np.inf
        return np.minimum(np.minimum(of_tip, of_kink), 0.06) * fineness

    on_line = [line[0]]
    for a, b in zip(line, line[1:]):
        # From both ends, each step as long as the mesh is fine there.
        length = np.linalg.norm(b - a)
        steps, s = [0.0], 0.0
        while s < length:
            here = a + (b - a) * s / length
            s += float(size(here[None])[0])
            steps.append(s)
        steps = np.array(steps) * length / steps[-1]
        on_line.extend(a + (b - a) * (s / length) for s in steps[1:])
    on_line = np.array(on_line)

    cells = [(0.0, float(row), 1.0) for row in range(height)]
    inside = []
    while cells:
        nodes = np.array([(x + s / 2, y + s / 2) for x, y, s in cells])
        wanted = size(nodes)
        finer = []
        for (x, y, s), w, c in zip(cells, wanted, nodes):
            if s > w:
                finer.extend((x + i * s / 2, y + j * s / 2, s / 2) for i in (0, 1) for j in (0, 1))
            else:
                inside.append((c[0], c[1]))
        cells = finer
    inside = np.array(inside)
    away = np.min([distance_to(inside, a, b) for a, b in zip(line, line[1:])], axis=0)
    inside = inside[away > 0.62 * size(inside)]
    edge = np.linspace(0, 1, round(25 / fineness) + 1)
    side = np.linspace(0, height, round(25 * height / fineness) + 1)[1:-1]
    border = [(t, 0.0) for t in edge] + [(t, float(height)) for t in edge] + [(1.0, t) for t in side]
    border += [(0.0, t) for t in side if abs(t - line[0][1]) > 0.02 * fineness]
    near_edge = np.minimum(inside, [1, height] - inside).min(axis=1) > 0.012 * fineness
    nodes = np.concatenate([on_line, np.array(border), inside[near_edge]])
    triangles = Delaunay(nodes).simplices
    corner = nodes[triangles]
    (x1, y1), (x2, y2) = (corner[:, 1] - corner[:, 0]).T, (corner[:, 2] - corner[:, 0]).T
    area = x1 * y2 - y1 * x2
    flat = np.abs(area) < 1e-13
    triangles[area < 0] = triangles[area < 0][:, ::-1]
    return nodes, triangles[~flat], len(on_line)


def split(nodes, triangles, count):
    """Doubles the nodes of the crack but its tip; triangles to its right get the new ones."""
    edges = {}
    for t, tri in enumerate(triangles):
        for k in range(3):
            edges[(tri[k], tri[(k + 1) % 3])] = t
    missing = [k for k in range(count - 1) if (k, k + 1) not in edges]
    assert not missing, f"{len(missing)} pieces of the crack are no edges"
    new = {k: len(nodes) + k for k in range(count - 1)}
    right = set()
    for k in range(count - 1):
        # Round the node from the edge of the crack on its right, through neighbours, until the crack comes again.
        start = [edges[(k + 1, k)]] if (k + 1, k) in edges else []
        if k > 0 and (k, k - 1) in edges:
            start.append(edges[(k, k - 1)])
        seen, stack = set(start), list(start)
        while stack:
            t = stack.pop()
            for i in range(3):
                a, b = triangles[t][i], triangles[t][(i + 1) % 3]
                if k not in (a, b) or (a < count and b < count and abs(int(a) - int(b)) == 1):
                    continue
                other = edges.get((b, a))
                if other is not None and other not in seen:
                    seen.add(other)
                    stack.append(other)
        right.update((t, k) for t in seen)
    result = triangles.copy()
    for t, k in right:
        result[t][triangles[t] == k] = new[k]
    return np.concatenate([nodes, nodes[: count - 1]]), result


GAUSS = np.array([[1 / 6, 1 / 6, 1 / 6], [2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6]])


def shapes(s, t):
    """Slopes of the six functions by (s, t): corners, then middles of 01, 12, 20."""
    r = 1 - s - t
    by_s = np.array([1 - 4 * r, 4 * s - 1, 0, 4 * (r - s), 4 * t, -4 * t])
    by_t = np.array([1 - 4 * r, 0, 4 * t - 1, -4 * s, 4 * s, 4 * (r - t)])
    value = np.array([r * (2 * r - 1), s * (2 * s - 1), t * (2 * t - 1), 4 * r * s, 4 * s * t, 4 * t * r])
    return value, by_s, by_t


def williams(mode, z):
    """Displacement gradient and stress of unit K at complex places z in the frame of the tip."""
    f1 = (1 if mode == 0 else -1j) / (2 * np.sqrt(2 * np.pi * z))
    f2 = -f1 / (2 * z)
    g1 = (0 if mode == 0 else -2) * f1 - z * f2
    total, rest = 4 * f1.real, 2 * (z.conj() * f2 + g1)
    stress = np.empty(z.shape + (2, 2))
    stress[..., 0, 0], stress[..., 1, 1] = (total - rest.real) / 2, (total + rest.real) / 2
    stress[..., 0, 1] = stress[..., 1, 0] = rest.imag / 2
    trace = stress[..., 0, 0] + stress[..., 1, 1]
    strain = (stress - POISSON * trace[..., None, None] * np.eye(2)) / (2 * MU)
    turn = (KOLOSOV + 1) / (2 * MU) * f1.imag
    gradient = strain.copy()
    gradient[..., 1, 0] += turn
    gradient[..., 0, 1] -= turn
    return gradient, stress


def factors(degrees, branch, fineness=1.0):
    """K_I and K_II over sqrt(pi a), a = 1/3, of a crack with a branch."""
    angle = np.radians(degrees)
    kink = np.array([PARENT, 0.5])
    line = [np.array([0.0, 0.5]), kink]
    if branch > 0:
        line.append(kink + branch * np.array([np.cos(angle), np.sin(angle)]))
    else:
        angle = 0.0
    radius = branch if branch > 0 else PARENT / 2
    return intensities(line, angle, radius, fineness) / np.sqrt(np.pi * PARENT)


def intensities(line, angle, radius, fineness, height=1, is_half=False):
    """K_I and K_II under tension 1 of a line whose last piece, longer than `radius`, is turned by `angle`. `is_half`: the plate
    goes on beyond its right edge as its mirror image."""
    nodes, triangles, count = mesh(line, radius, fineness, height)
    nodes, triangles = split(nodes, triangles, count)
    middles, six, places = {}, [], list(nodes)
    for tri in triangles:
        own = list(tri)
        for k in range(3):
            pair = tuple(sorted((tri[k], tri[(k + 1) % 3])))
            if pair not in middles:
                middles[pair] = len(places)
                places.append((nodes[pair[0]] + nodes[pair[1]]) / 2)
            own.append(middles[pair])
        six.append(own)
    six, places = np.array(six), np.array(places)
    stiffness, states = [], []
    corner = nodes[triangles]
    d1, d2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    det = d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0]
    elastic = np.array([[LAMBDA + 2 * MU, LAMBDA, 0], [LAMBDA, LAMBDA + 2 * MU, 0], [0, 0, MU]])
    local = np.zeros((len(six), 12, 12))
    for s, t, weight in GAUSS:
        _, by_s, by_t = shapes(s, t)
        # Gradients in the plane: the inverse of the matrix of the two edges.
        gx = (by_s[None] * d2[:, 1:2] - by_t[None] * d1[:, 1:2]) / det[:, None]
        gy = (-by_s[None] * d2[:, 0:1] + by_t[None] * d1[:, 0:1]) / det[:, None]
        b = np.zeros((len(six), 3, 12))
        b[:, 0, 0::2], b[:, 1, 1::2] = gx, gy
        b[:, 2, 0::2], b[:, 2, 1::2] = gy, gx
        local += np.einsum("eki,kl,elj->eij", b, elastic, b) * (det * weight)[:, None, None]
        states.append((s, t, weight, gx, gy))
    dof = np.stack([2 * six, 2 * six + 1], -1).reshape(len(six), 12)
    rows, columns = np.repeat(dof, 12, 1).ravel(), np.tile(dof, (1, 12)).ravel()
    n = 2 * len(places)
    matrix = coo_matrix((local.ravel(), (rows, columns)), (n, n)).tocsr()
    force = np.zeros(n)
    for a, b in middles:
        for level, pull in ((0.0, -1.0), (float(height), 1.0)):
            if nodes[a][1] == level and nodes[b][1] == level:
                length = abs(nodes[a][0] - nodes[b][0])
                for node, part in ((a, 1 / 6), (b, 1 / 6), (middles[(a, b)], 4 / 6)):
                    force[2 * node + 1] += pull * part * length
    # Far from everything, at the right edge: as a rigid body it is held there.
    right = np.flatnonzero(places[:, 0] == 1.0)
    low, high = right[np.argmin(places[right, 1])], right[np.argmax(places[right, 1])]
    held = [*(2 * right), 2 * low + 1] if is_half else [2 * low, 2 * low + 1, 2 * high]
    free = np.setdiff1d(np.arange(n), held)
    u = np.zeros(n)
    u[free] = spsolve(matrix[free][:, free].tocsc(), force[free])
    u = u.reshape(-1, 2)
    tip, turn = line[-1], np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    inner, outer = 0.1 * radius, 0.85 * radius
    found = [0.0, 0.0]
    for s, t, weight, gx, gy in states:
        value, _, _ = shapes(s, t)
        place = np.einsum("k,eki->ei", value, places[six]) - tip
        place = place @ turn.T
        r = np.hypot(*place.T)
        ring = (r > inner) & (r < outer)
        x = (r[ring] - inner) / (outer - inner)
        slope = -30 * x**2 * (1 - x) ** 2 / (outer - inner)
        q = place[ring] / r[ring, None] * slope[:, None]
        h = np.stack([np.einsum("ek,eki->ei", g[ring], u[six[ring]]) for g in (gx, gy)], -1)
        h = turn @ h @ turn.T
        strain = (h + h.transpose(0, 2, 1)) / 2
        stress = LAMBDA * np.trace(strain, axis1=1, axis2=2)[:, None, None] * np.eye(2) + 2 * MU * strain
        for mode in (0, 1):
            gradient, auxiliary = williams(mode, place[ring, 0] + 1j * place[ring, 1])
            flux = np.einsum("eij,ei->ej", stress, gradient[:, :, 0]) + np.einsum("eij,ei->ej", auxiliary, h[:, :, 0])
            mutual = np.einsum("eij,eij->e", auxiliary, strain)
            total = np.einsum("ej,ej->e", flux, q) - mutual * q[:, 0]
            found[mode] += MODULUS / 2 * (total * det[ring] * weight).sum()
    return np.array(found)


if __name__ == "__main__":
    fineness = float(sys.argv[1]) if len(sys.argv) > 1 else 0.5
    print("straight: %.4f %.4f" % tuple(factors(0.0, 0.0, fineness)))
    for degrees in (-30.0, -60.0):
        for branch in (0.5, 1.0, 2.0, 4.0, 8.0):
            print(f"({degrees}, {branch}, " + "[%.4f, %.4f])," % tuple(factors(degrees, branch / 48, fineness)), flush=True)

#!/usr/bin/env python3
"""Path of a crack past three holes, by finite elements.

The beam of the case `three-holes` (crates/verify): 20 by 8 inches, held at (1, 0) and (19, 0), pushed down at (10, 8), holes of diameter 0.5 at x = 6 and
y = 2.75, 4.75, 6.75, a notch of 1 in at x = 4. The crack takes the direction of the largest hoop stress (Erdogan & Sih 1963) in every increment, on a new
mesh each: quadratic triangles graded geometrically towards the tip, K by the interaction integral in a ring of at most 0.1 in around it, three fifths of
the way to the next hole.

    python3 pipeline/references/three_holes.py [increment [fineness]] > path.csv

Needs numpy, scipy, gmsh and scikit-fem. Prints x, y [in], K_I and K_II per load of 1 lb/in [sqrt in]. Some minutes with increments of 0.015 in.
"""

import sys

import gmsh
import numpy as np
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, MeshTri
from skfem.helpers import ddot, sym_grad, trace

# Plane stress; with tractions only, K depends on neither constant.
YOUNG, POISSON = 1.0, 0.3
MU = YOUNG / 2 / (1 + POISSON)
LAMBDA = YOUNG * POISSON / (1 - POISSON**2)
KOLOSOV = (3 - POISSON) / (1 + POISSON)
HOLES, RADIUS = [(6.0, 2.75), (6.0, 4.75), (6.0, 6.75)], 0.25
HELD, PUSHED = [(1.0, 0.0), (19.0, 0.0)], (10.0, 8.0)
RING = 0.1


def mesh(crack, ring, fineness):
    """Triangles of the beam, whose faces along the crack are two."""
    geometry = gmsh.model.geo
    gmsh.model.add("beam")

    def point(x, y):
        return geometry.addPoint(x, y, 0)

    on_crack = [point(*p) for p in crack]
    corners = [point(0, 0), point(*HELD[0]), on_crack[0], point(*HELD[1]), point(20, 0), point(20, 8), point(*PUSHED), point(0, 8)]
    loops = [geometry.addCurveLoop([geometry.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1])])]
    cut = [geometry.addLine(a, b) for a, b in zip(on_crack, on_crack[1:])]
    for x, y in HOLES:
        middle = point(x, y)
        around = [point(x + RADIUS * np.cos(t), y + RADIUS * np.sin(t)) for t in np.arange(4) * np.pi / 2]
        loops.append(geometry.addCurveLoop([geometry.addCircleArc(around[k], middle, around[(k + 1) % 4]) for k in range(4)]))
    surface = geometry.addPlaneSurface(loops)
    geometry.synchronize()
    gmsh.model.mesh.embed(1, cut, 2, surface)
    gmsh.model.addPhysicalGroup(1, cut, 1)
    gmsh.model.addPhysicalGroup(0, [on_crack[0]], 2)
    gmsh.model.addPhysicalGroup(2, [surface], 3)

    def away(x, y):
        return f"sqrt((x-({x:.12f}))^2+(y-({y:.12f}))^2)"

    sizes = [f"min(0.5, max({ring / 300 / fineness:.12f}, {0.16 / fineness:.12f}*{away(*crack[-1])}))"]
    sizes += [f"{0.03 / fineness:.12f}+{0.3 / fineness:.12f}*abs({away(*hole)}-{RADIUS})" for hole in HOLES]
    sizes += [f"0.03+0.3*{away(*place)}" for place in [*HELD, PUSHED]]
    field = gmsh.model.mesh.field
    parts = [field.add("MathEval") for _ in sizes]
    for part, size in zip(parts, sizes):
        field.setString(part, "F", size)
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", parts)
    field.setAsBackgroundMesh(least)
    gmsh.model.mesh.generate(2)
    for key, value in (("Dimension", 1), ("PhysicalGroup", 1), ("OpenBoundaryPhysicalGroup", 2)):
        gmsh.plugin.setNumber("Crack", key, value)
    gmsh.plugin.run("Crack")

    tags, places, _ = gmsh.model.mesh.getNodes()
    places = places.reshape(-1, 3)[:, :2]
    number = np.zeros(int(tags.max()) + 1, dtype=int)
    number[tags.astype(int)] = np.arange(len(tags))
    _, triangles = gmsh.model.mesh.getElementsByType(2)
    used, triangles = np.unique(number[triangles.astype(int)], return_inverse=True)
    gmsh.model.remove()
    return MeshTri(np.ascontiguousarray(places[used].T), np.ascontiguousarray(triangles.reshape(-1, 3).T))


@BilinearForm
def stiffness(u, v, _):
    a, b = sym_grad(u), sym_grad(v)
    return LAMBDA * trace(a) * trace(b) + 2 * MU * ddot(a, b)


def near_field(x, y, mode):
    """Gradient of the displacements around a tip at the origin with K of 1 (Williams 1957)."""
    r, t = np.hypot(x, y), np.arctan2(y, x)
    cos, sin, c, s = np.cos(t / 2), np.sin(t / 2), np.cos(t), np.sin(t)
    if mode == 1:
        u = [cos * (KOLOSOV - c), sin * (KOLOSOV - c)]
        du = [-sin / 2 * (KOLOSOV - c) + cos * s, cos / 2 * (KOLOSOV - c) + sin * s]
    else:
        u = [sin * (KOLOSOV + 2 + c), -cos * (KOLOSOV - 2 + c)]
        du = [cos / 2 * (KOLOSOV + 2 + c) - sin * s, sin / 2 * (KOLOSOV - 2 + c) + cos * s]
    factor = 1 / (2 * MU * np.sqrt(2 * np.pi * r))
    along, around = [factor * f / 2 for f in u], [factor * f for f in du]
    return np.array([[a * c - b * s, a * s + b * c] for a, b in zip(along, around)])


def stress(gradient):
    strain = (gradient + np.swapaxes(gradient, 0, 1)) / 2
    found = 2 * MU * strain
    for k in range(2):
        found[k, k] += LAMBDA * (strain[0, 0] + strain[1, 1])
    return found, strain


def intensities(crack, ring, fineness):
    """K_I and K_II at the end of a crack."""
    triangles = mesh(crack, ring, fineness)
    element = ElementVector(ElementTriP2())
    basis = Basis(triangles, element, intorder=4)

    def number_at(place, axis):
        node = np.argmin(np.hypot(*(triangles.p.T - place).T))
        return basis.nodal_dofs[axis, node]

    force = np.zeros(basis.N)
    force[number_at(PUSHED, 1)] = -1
    held = [number_at(HELD[0], 0), number_at(HELD[0], 1), number_at(HELD[1], 1)]
    free = np.setdiff1d(np.arange(basis.N), held)
    matrix = stiffness.assemble(basis)[free][:, free].tocsc()
    u = np.zeros(basis.N)
    u[free] = splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(force[free])

    tip = np.array(crack[-1])
    ahead = (tip - crack[-2]) / np.hypot(*(tip - crack[-2]))
    turn = np.array([ahead, [-ahead[1], ahead[0]]])
    middles = triangles.p[:, triangles.t].mean(axis=1)
    around = Basis(triangles, element, intorder=8, elements=np.flatnonzero(np.hypot(*(middles.T - tip).T) < 1.5 * ring))
    local = np.einsum("ij,j...->i...", turn, around.global_coordinates().value - tip[:, None, None])
    gradient = np.einsum("ik,kl...,jl->ij...", turn, around.interpolate(u).grad, turn)
    sigma, _ = stress(gradient)
    # From 1 to 0 over the outer three fifths of the ring.
    r = np.hypot(*local)
    part = np.clip((r - 0.4 * ring) / (0.6 * ring), 0, 1)
    slope = -6 * part * (1 - part) / (0.6 * ring) * local / r
    found = []
    for mode in (1, 2):
        field = near_field(*local, mode)
        sigma_of_field, strain_of_field = stress(field)
        # Yau, Wang & Corten 1980, eq. 10.
        flow = np.einsum("ij...,i...->j...", sigma, field[:, 0]) + np.einsum("ij...,i...->j...", sigma_of_field, gradient[:, 0])
        both = np.einsum("ij...,ij...->...", sigma, strain_of_field)
        found.append(YOUNG / 2 * np.sum((both * slope[0] - np.einsum("j...,j...->...", flow, slope)) * around.dx))
    return -np.array(found)


def kink(mode_1, mode_2):
    """Erdogan & Sih 1963: the angle of the largest hoop stress."""
    return 2 * np.arctan((mode_1 - np.hypot(mode_1, np.sqrt(8) * mode_2)) / (4 * mode_2)) if abs(mode_2) > 1e-14 else 0.0


def main():
    increment = float(sys.argv[1]) if len(sys.argv) > 1 else 0.015
    fineness = float(sys.argv[2]) if len(sys.argv) > 2 else 1.0
    gmsh.initialize()
    for name, value in (("General.Terminal", 0), ("Mesh.Algorithm", 6), ("Mesh.MeshSizeExtendFromBoundary", 0), ("Mesh.MeshSizeFromPoints", 0)):
        gmsh.option.setNumber(name, value)
    crack, angle = [np.array([4.0, 0.0]), np.array([4.0, 1.0])], np.pi / 2
    while True:
        tip = crack[-1]
        gap = min(np.hypot(*(tip - hole)) for hole in HOLES) - RADIUS
        if gap < 0.02:
            break
        mode_1, mode_2 = intensities(crack, min(RING, 0.6 * gap), fineness)
        print(f"{tip[0]:.6f},{tip[1]:.6f},{mode_1:.6f},{mode_2:.6f}", flush=True)
        angle += kink(mode_1, mode_2)
        crack.append(tip + min(increment, gap / 2) * np.array([np.cos(angle), np.sin(angle)]))


if __name__ == "__main__":
    main()

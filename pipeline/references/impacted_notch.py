#!/usr/bin/env python3
"""Stress intensities of the resting notch in the impacted plate, by finite elements, with and without contact of its faces.

The plate of the case `impacted-notch` (crates/verify): 100 x 100 mm, notch of 50 mm at y = 25 mm, u_y = 0 at y = 0, the left edge below the notch driven
at 16.5 m/s, reached within 1 us; E = 190 GPa, nu = 0.3, rho = 8000 kg/m3, plane strain, frictionless faces. Squares with bilinear functions and lumped
mass, central differences, K by the interaction integral with its inertia term. Faces may approach by what is left of their gap in a step.

    python3 pipeline/references/impacted_notch.py [element size in mm ...]

Needs numpy. A quarter of a millimetre takes some 20 s. Errors fall with the element size: halving it from 0.5 mm moves the times below by 0.015 us.
"""

import sys

import numpy as np

YOUNG, POISSON, DENSITY = 190e9, 0.3, 8000.0
TOUGHNESS = 68e6
SIDE, NOTCH, HEIGHT = 0.1, 0.05, 0.025
SPEED, RISE = 16.5, 1e-6
TIMES = (12e-6, 13.2e-6, 14.4e-6)
LAMBDA = YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON)
MU = YOUNG / 2 / (1 + POISSON)
KOLOSOV = 3 - 4 * POISSON
# q falls from 1 to 0 between these distances from the tip.
INNER, OUTER = 1.5e-3, 8e-3


def stress_of(gradient):
    strain = 0.5 * (gradient + gradient.transpose(0, 2, 1))
    trace = np.trace(strain, axis1=1, axis2=2)
    return strain, 2 * MU * strain + LAMBDA * trace[:, None, None] * np.eye(2)


def williams_gradient(mode, place):
    """u_i,j of unit K_I or K_II (mode 0 or 1), by differences of the displacement in polar coordinates."""
    radius, angle = np.hypot(*place.T), np.arctan2(place[:, 1], place[:, 0])

    def displacement(r, a):
        s, c = np.sin(a / 2), np.cos(a / 2)
        if mode == 0:
            parts = [c * (KOLOSOV - 1 + 2 * s * s), s * (KOLOSOV + 1 - 2 * c * c)]
        else:
            parts = [s * (KOLOSOV + 1 + 2 * c * c), -c * (KOLOSOV - 1 - 2 * s * s)]
        return (np.sqrt(r / (2 * np.pi)) / (2 * MU))[:, None] * np.stack(parts, -1)

    d = 1e-5
    along = (displacement(radius * (1 + d), angle) - displacement(radius * (1 - d), angle)) / (2 * d * radius)[:, None]
    around = (displacement(radius, angle + d) - displacement(radius, angle - d)) / (2 * d * radius)[:, None]
    ahead = place / radius[:, None]
    left = np.stack([-ahead[:, 1], ahead[:, 0]], -1)
    return along[:, :, None] * ahead[:, None, :] + around[:, :, None] * left[:, None, :]


class Plate:
    """Elements, masses and state. Nodes of the upper face of the notch are the last ones."""

    def __init__(self, size):
        self.size = size
        cells, row, along = (round(length / size) for length in (SIDE, HEIGHT, NOTCH))
        grid = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
        self.upper = grid.size + np.arange(along)
        self.lower = grid[row, :along]
        elements = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], -1)
        face = np.append(self.upper, grid[row, along])
        elements[row, :along, 0], elements[row, :along, 1] = face[:-1], face[1:]
        self.elements = elements.reshape(-1, 4)
        self.driven = np.append(grid[:row, 0], self.lower[0])
        self.floor = grid[0]
        nodes = grid.size + along
        self.place = np.zeros((nodes, 2))
        self.place[: grid.size] = np.stack(np.divmod(np.arange(grid.size), cells + 1)[::-1], -1) * size
        self.place[self.upper] = self.place[self.lower]
        self.mass = np.bincount(self.elements.ravel(), minlength=nodes) * DENSITY * size**2 / 4
        self.displacement, self.velocity = np.zeros((nodes, 2)), np.zeros((nodes, 2))
        self.acceleration = np.zeros((nodes, 2))
        self.points = [self.shape(x, y) for x, y in np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / np.sqrt(3)]
        elasticity = np.array([[LAMBDA + 2 * MU, LAMBDA, 0], [LAMBDA, LAMBDA + 2 * MU, 0], [0, 0, MU]])
        self.stiffness = np.zeros((8, 8))
        for _, slope in self.points:
            strain = np.zeros((3, 8))
            strain[0, 0::2] = strain[2, 1::2] = slope[0]
            strain[1, 1::2] = strain[2, 0::2] = slope[1]
            self.stiffness += strain.T @ elasticity @ strain * size**2 / 4
        self.freedoms = np.stack([2 * self.elements, 2 * self.elements + 1], -1).ravel()
        distance = np.hypot(*(self.place[self.elements].mean(1) - (NOTCH, HEIGHT)).T)
        self.near = self.elements[distance < OUTER + 2 * size]

    def shape(self, x, y):
        value = np.array([(1 - x) * (1 - y), (1 + x) * (1 - y), (1 + x) * (1 + y), (1 - x) * (1 + y)]) / 4
        slope = np.array([[y - 1, 1 - y, 1 + y, -1 - y], [x - 1, -1 - x, 1 + x, 1 - x]]) / (2 * self.size)
        return value, slope

    def step(self, time, length, contact):
        local = self.displacement[self.elements].reshape(-1, 8)
        force = np.bincount(self.freedoms, (-local @ self.stiffness).ravel(), minlength=2 * len(self.mass))
        velocity = self.velocity + length * force.reshape(-1, 2) / self.mass[:, None]
        velocity[self.floor, 1] = 0
        velocity[self.driven, 0] = SPEED * min(1, (time + length / 2) / RISE)
        if contact:
            gap = self.displacement[self.upper, 1] - self.displacement[self.lower, 1]
            speed = velocity[self.upper, 1] - velocity[self.lower, 1]
            above, below = self.mass[self.upper], self.mass[self.lower]
            impulse = np.maximum(0, -gap / length - speed) * above * below / (above + below)
            velocity[self.upper, 1] += impulse / above
            velocity[self.lower, 1] -= impulse / below
        self.acceleration = (velocity - self.velocity) / length
        self.velocity = velocity
        # What is measured belongs to the beginning of the step.
        before, self.displacement = self.displacement, self.displacement + length * velocity
        return before

    def stress_intensities(self, displacement):
        found = np.zeros(2)
        for value, slope in self.points:
            place = np.einsum("n,enk->ek", value, self.place[self.near]) - (NOTCH, HEIGHT)
            gradient = np.einsum("jn,enk->ekj", slope, displacement[self.near])
            inertia = DENSITY * np.einsum("n,enk->ek", value, self.acceleration[self.near])
            radius = np.hypot(*place.T)
            t = np.clip((radius - INNER) / (OUTER - INNER), 0, 1)
            q = 1 - t**3 * (10 - t * (15 - 6 * t))
            slope_of_q = place / radius[:, None] * (-30 * t**2 * (1 - t) ** 2 / (OUTER - INNER))[:, None]
            strain, stress = stress_of(gradient)
            for mode in (0, 1):
                auxiliary = williams_gradient(mode, place)
                _, auxiliary_stress = stress_of(auxiliary)
                flux = np.einsum("eij,ei->ej", stress, auxiliary[:, :, 0])
                flux += np.einsum("eij,ei->ej", auxiliary_stress, gradient[:, :, 0])
                flux[:, 0] -= np.einsum("eij,eij->e", auxiliary_stress, strain)
                area = np.einsum("ei,ei->e", inertia, auxiliary[:, :, 0]) * q
                found[mode] += (np.einsum("ej,ej->e", flux, slope_of_q) + area).sum() * self.size**2 / 4
        return YOUNG / (1 - POISSON**2) / 2 * found


def compute(size, contact):
    plate = Plate(size)
    length = 0.6 * size / np.sqrt((LAMBDA + 2 * MU) / DENSITY)
    history = []
    for number in range(int(15e-6 / length)):
        before = plate.step(number * length, length, contact)
        if number * length > 11e-6:
            history.append((number * length, *plate.stress_intensities(before)))
    time, mode_1, mode_2 = np.array(history).T
    print(f"elements of {1e3 * size:g} mm, {'with' if contact else 'without'} contact")
    for at in TIMES:
        # Of closed faces the integral would have to take off what their pressure does on the opening; it does nothing on the sliding.
        opening = "" if contact else f"K_I {1e-6 * np.interp(at, time, mode_1):.2f}, "
        print(f"  {1e6 * at:.1f} us: {opening}K_II {1e-6 * np.interp(at, time, mode_2):.2f} MPa sqrt(m)")
    start = np.interp(np.sqrt(0.75) * TOUGHNESS, -mode_2, time)
    print(f"  |K_II| reaches (sqrt(3)/2) K_Ic at {1e6 * start:.3f} us")


if __name__ == "__main__":
    for argument in sys.argv[1:] or ["0.5"]:
        for contact in (False, True):
            compute(1e-3 * float(argument), contact)

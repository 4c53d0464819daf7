#!/usr/bin/env python3
"""Stress intensity at two notches that face each other, by finite elements.

The plate of the case `double-notch` (crates/verify): width 2, height 6, under tension 1 on its upper and lower edges, notches of length a at mid height from
both sides. Its left half, held along the axis of symmetry, with the elements and the interaction integral of drawn_kinks.py.

    python3 pipeline/references/double_notch.py [fineness]

Needs numpy and scipy. Prints K_I over sigma sqrt(pi a).
"""

import sys

import numpy as np
from drawn_kinks import intensities

if __name__ == "__main__":
    fineness = float(sys.argv[1]) if len(sys.argv) > 1 else 0.5
    for length in (0.25, 0.5):
        line = [np.array([0.0, 3.0]), np.array([length, 3.0])]
        found = intensities(line, 0.0, length / 2, fineness, height=6, is_half=True)
        print(f"a/b {length}: %.4f %.4f" % tuple(found / np.sqrt(np.pi * length)), flush=True)

#!/usr/bin/env python3
"""Paints veins.png, the toughness of the tile: dark veins on white. Needs numpy and Pillow.

    python examples/painted/paint.py
"""
from pathlib import Path

import numpy as np
from PIL import Image

WIDTH, HEIGHT = 400, 240  # pixels; a millimetre each
SOFTNESS = 3.0  # pixels from the middle of a vein to where it has faded to 60 %

x = np.linspace(0, WIDTH, 2001)
# Rows count from the top. One vein is for the crack from the left, one for that from the right, and three lead astray.
upper = 80 - 34 * np.sin(2 * np.pi * x / 190) * np.clip(x / 60, 0, 1)
lower = 165 + 26 * np.sin(2 * np.pi * (WIDTH - x) / 150) * np.clip((WIDTH - x) / 60, 0, 1)
veins = [np.stack([x, upper], 1), np.stack([x, lower], 1)]
for start, side, end in ((130, upper, (200, 0)), (235, upper, (300, 130)), (120, lower, (60, 240))):
    foot = np.array([start, np.interp(start, x, side)])
    t = np.linspace(0, 1, 1001)[:, None]
    veins.append(foot + t * (np.array(end) - foot) + 8 * np.sin(np.pi * t) * [1, 0])

columns, rows = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
distance = np.full((HEIGHT, WIDTH), np.inf)
for point in np.concatenate(veins):
    distance = np.minimum(distance, np.hypot(columns - point[0], rows - point[1]))
shade = 255 * (1 - np.exp(-0.5 * (distance / SOFTNESS) ** 2))
Image.fromarray(np.round(shade).astype(np.uint8)).save(Path(__file__).with_name("veins.png"), optimize=True)

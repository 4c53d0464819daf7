#!/usr/bin/env python3
"""Draws GLB frames side by side as one small PNG: a z-buffer, one light, nothing else.

    python pipeline/picture.py out/pull/pull.0012.glb out/pull/pull.0048.glb -o picture.png
    python pipeline/picture.py out/drop/drop.0045.glb+out/drop/drop_collider.0045.glb -o picture.png

Files joined by `+` are drawn over each other; the first decides what is in view.
Needs numpy, Pillow and trimesh (pipeline/checks/requirements.txt).
"""
import argparse

import numpy as np
import trimesh
from PIL import Image

COLOURS = {"outside": (0.74, 0.80, 0.86), "inside": (0.93, 0.42, 0.19), "collider": (0.55, 0.55, 0.55)}
LIGHT = np.array([-0.35, 0.55, 0.76])
SAMPLES = 3  # per pixel and direction


def triangles(path):
    """Corners (n, 3, 3) and colour (n, 3) of all triangles of a GLB, y up."""
    scene = trimesh.load(path, process=False)
    corners, colours = [], []
    for name in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[name]
        mesh = scene.geometry[geometry]
        if not isinstance(mesh, trimesh.Trimesh):
            continue
        material = getattr(getattr(mesh.visual, "material", None), "name", "") or "outside"
        colour = COLOURS["collider" if "_collider_" in name else material]
        points = trimesh.transform_points(mesh.vertices, transform)
        corners.append(points[mesh.faces])
        colours.append(np.tile(colour, (len(mesh.faces), 1)))
    return np.concatenate(corners), np.concatenate(colours)


def turn(yaw, pitch):
    """Rotation that turns the drawing towards the camera, which looks along -z."""
    cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    return np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]]) @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])


def draw(corners, colours, low, high, width, height):
    """An image (height, width, 3) of triangles in view space; `low` and `high` bound what is seen."""
    scale = min(width / (high[0] - low[0]), height / (high[1] - low[1]))
    centre = (low[:2] + high[:2]) / 2
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    shade = 0.35 + 0.65 * np.clip(normals @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)
    seen = normals[:, 2] > 0  # the others turn away; the meshes are closed
    image = np.ones((height, width, 3))
    depth = np.full((height, width), -np.inf)
    pixels = (corners[seen, :, :2] - centre) * scale * [1, -1] + [width / 2, height / 2]
    for p, z, colour in zip(pixels, corners[seen, :, 2], colours[seen] * shade[seen, None]):
        x0, y0 = np.maximum(np.floor(p.min(0) - 0.5).astype(int), 0)
        x1, y1 = np.minimum(np.ceil(p.max(0) + 0.5).astype(int), [width, height])
        area = np.linalg.det(np.stack([p[1] - p[0], p[2] - p[0]]))
        if x0 >= x1 or y0 >= y1 or abs(area) < 1e-12:
            continue
        x, y = np.meshgrid(np.arange(x0, x1) + 0.5, np.arange(y0, y1) + 0.5)
        weights = []
        for a, b in ((p[1], p[2]), (p[2], p[0]), (p[0], p[1])):
            weights.append(((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area)
        inside = np.min(weights, axis=0) >= 0
        here = z[0] * weights[0] + z[1] * weights[1] + z[2] * weights[2]
        window = (slice(y0, y1), slice(x0, x1))
        nearer = inside & (here > depth[window])
        depth[window][nearer] = here[nearer]
        image[window][nearer] = colour
    return image


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("frames", nargs="+", help="GLB files, drawn from left to right")
    parser.add_argument("-o", "--output", required=True, help="PNG file")
    parser.add_argument("--size", type=int, default=300, help="height in pixels")
    parser.add_argument("--yaw", type=float, default=-25, help="degrees about the upright axis")
    parser.add_argument("--pitch", type=float, default=18, help="degrees from above")
    options = parser.parse_args()
    rotation = turn(np.radians(options.yaw), np.radians(options.pitch))
    frames, in_view = [], []
    for group in options.frames:
        parts = [triangles(path) for path in group.split("+")]
        in_view.append(parts[0][0].reshape(-1, 3) @ rotation.T)
        corners, colours = (np.concatenate(arrays) for arrays in zip(*parts))
        frames.append((corners @ rotation.T, colours))
    in_view = np.concatenate(in_view)
    low, high = in_view.min(0), in_view.max(0)
    margin = 0.04 * (high - low).max()
    low, high = low - margin, high + margin
    height = options.size * SAMPLES
    width = int(height * (high[0] - low[0]) / (high[1] - low[1]))
    image = np.concatenate([draw(c, k, low, high, width, height) for c, k in frames], axis=1)
    picture = Image.fromarray((255 * np.clip(image, 0, 1) ** (1 / 1.1)).astype(np.uint8))
    picture = picture.resize((picture.width // SAMPLES, picture.height // SAMPLES), Image.Resampling.LANCZOS)
    picture.quantize(128, dither=Image.Dither.NONE).save(options.output, optimize=True)


if __name__ == "__main__":
    main()

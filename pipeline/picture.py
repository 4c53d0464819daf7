#!/usr/bin/env python3
"""Draws GLB frames side by side as one small PNG: a z-buffer, one light, and a line along cracks.

    python pipeline/picture.py out/pull/pull.0012.glb out/pull/pull.0048.glb -o picture.png
    python pipeline/picture.py out/drop/drop.0045.glb+out/drop/drop_collider.0045.glb -o picture.png

Files joined by `+` are drawn over each other; the first decides what is in view. A crack that is hardly open shows as
a line: where a crack face meets the surface.
Needs numpy, Pillow and trimesh (pipeline/checks/requirements.txt).
"""
import argparse

import numpy as np
import trimesh
from PIL import Image

COLOURS = {"outside": (0.74, 0.80, 0.86), "inside": (0.93, 0.42, 0.19), "collider": (0.55, 0.55, 0.55)}
LIGHT = np.array([-0.35, 0.55, 0.76])
LINE = np.array([0.55, 0.20, 0.07])
MARK = np.array([0.16, 0.30, 0.52])
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


def rims(corners, colours):
    """Edges (n, 2, 3) where a crack face meets the surface; corners and colours as of `triangles`."""
    size = np.ptp(corners.reshape(-1, 3), axis=0).max()
    keys = np.round(corners / size * 1e7).astype(np.int64)
    is_inside = (colours == COLOURS["inside"]).all(1)
    is_outside = (colours == COLOURS["outside"]).all(1)

    def edges(which):
        pairs = np.concatenate([keys[which][:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
        places = np.concatenate([corners[which][:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
        return {frozenset(map(tuple, pair)): place for pair, place in zip(pairs.tolist(), places)}

    surface = edges(is_outside)
    shared = [place for key, place in edges(is_inside).items() if key in surface]
    return np.array(shared).reshape(-1, 2, 3)


def circle(x, y, radius, z):
    """A circle as lines (n, 2, 3)."""
    angle = np.linspace(0, 2 * np.pi, 97)
    ring = np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle), np.full_like(angle, z)], 1)
    return np.stack([ring[:-1], ring[1:]], 1)


def draw_lines(image, depth, lines, colour, scale, centre, width):
    """Draws lines (n, 2, 3) in view space over an image where nothing nearer hides them."""
    height, columns = depth.shape
    ends = lines[:, :, :2] - centre
    ends = ends * scale * [1, -1] + [columns / 2, height / 2]
    reach = np.arange(width) - (width - 1) / 2
    for (p, q), (z_p, z_q) in zip(ends, lines[:, :, 2]):
        t = np.linspace(0, 1, int(np.abs(q - p).max()) + 2)
        x = np.floor(p[0] + t * (q[0] - p[0]))[:, None, None] + reach[None, :, None]
        y = np.floor(p[1] + t * (q[1] - p[1]))[:, None, None] + reach[None, None, :]
        z = np.broadcast_to((z_p + t * (z_q - z_p))[:, None, None], (len(t), width, width))
        x, y = np.broadcast_arrays(x, y)
        x, y, z = x.astype(int).ravel(), y.astype(int).ravel(), z.ravel()
        seen = (x >= 0) & (x < columns) & (y >= 0) & (y < height)
        x, y, z = x[seen], y[seen], z[seen]
        nearest = z > depth[y, x] - 2 * width / scale
        image[y[nearest], x[nearest]] = colour


def turn(yaw, pitch):
    """Rotation that turns the drawing towards the camera, which looks along -z."""
    cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    return np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]]) @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])


def draw(corners, colours, marks, lines, low, high, width, height):
    """An image (height, width, 3) of triangles and lines in view space; `low` and `high` bound what is seen."""
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
    draw_lines(image, depth, marks, MARK, scale, centre, SAMPLES)
    draw_lines(image, depth, lines, LINE, scale, centre, SAMPLES)
    return image


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("frames", nargs="+", help="GLB files, drawn from left to right")
    parser.add_argument("-o", "--output", required=True, help="PNG file")
    parser.add_argument("--size", type=int, default=300, help="height in pixels")
    parser.add_argument("--yaw", type=float, default=-25, help="degrees about the upright axis")
    parser.add_argument("--pitch", type=float, default=18, help="degrees from above")
    parser.add_argument("--circle", action="append", default=[], metavar="X,Y,RADIUS", help="a circle drawn on the front")
    options = parser.parse_args()
    rotation = turn(np.radians(options.yaw), np.radians(options.pitch))
    frames, in_view = [], []
    for group in options.frames:
        parts = [triangles(path) for path in group.split("+")]
        in_view.append(parts[0][0].reshape(-1, 3) @ rotation.T)
        corners, colours = (np.concatenate(arrays) for arrays in zip(*parts))
        circles = [circle(*map(float, c.split(",")), corners[:, :, 2].max()) for c in options.circle]
        marks = np.concatenate([np.empty((0, 2, 3)), *circles])
        frames.append((corners @ rotation.T, colours, marks @ rotation.T, rims(corners, colours) @ rotation.T))
    in_view = np.concatenate(in_view)
    low, high = in_view.min(0), in_view.max(0)
    margin = 0.04 * (high - low).max()
    low, high = low - margin, high + margin
    height = options.size * SAMPLES
    width = int(height * (high[0] - low[0]) / (high[1] - low[1]))
    image = np.concatenate([draw(*frame, low, high, width, height) for frame in frames], axis=1)
    picture = Image.fromarray((255 * np.clip(image, 0, 1) ** (1 / 1.1)).astype(np.uint8))
    picture = picture.resize((picture.width // SAMPLES, picture.height // SAMPLES), Image.Resampling.LANCZOS)
    picture.quantize(128, dither=Image.Dither.NONE).save(options.output, optimize=True)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Renders a run of Fissure with Cycles, without a window.

    python pipeline/blender/render_run.py out/pull --look stone --frames 1,24,48            # PNG files
    python pipeline/blender/render_run.py out/pull --look glass --mp4 pull.mp4              # a film
    blender --background --python pipeline/blender/render_run.py -- out/pull --look clay    # with Blender's own Python

The first two need Blender as a module (`pip install bpy`). The meshes must be GLB files, which `fissure run` writes.
"""

import argparse
import math
import pathlib
import sys

import bpy
from mathutils import Vector

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from fissure_run.glb_file import NotReadable  # noqa: E402
from fissure_run.import_run import import_run  # noqa: E402
from fissure_run.looks import LOOKS  # noqa: E402


def frame_numbers(text):
    """The numbers of `1,10,20-30` or `1-45x2`."""
    numbers = set()
    for part in text.split(","):
        span, _, stride = part.partition("x")
        first, _, last = span.partition("-")
        numbers |= set(range(int(first), int(last or first) + 1, int(stride or 1)))
    return numbers


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=pathlib.Path, help="the folder that fissure run has written")
    parser.add_argument("--look", choices=sorted(LOOKS), default="clay")
    parser.add_argument("--frames", type=frame_numbers, help="for example 1,10,20-30 or 1-45x2; default: all")
    parser.add_argument("--output", type=pathlib.Path, help="folder for the pictures; default: `render` in that of the run")
    parser.add_argument("--mp4", type=pathlib.Path, help="write a film instead of pictures")
    parser.add_argument("--jpeg", action="store_true", help="write JPEG instead of PNG files")
    parser.add_argument("--size", type=int, default=960, help="width in pixels")
    parser.add_argument("--samples", type=int, default=64, help="per pixel; more is less noise")
    parser.add_argument("--yaw", type=float, default=-25, help="degrees about the upright axis")
    parser.add_argument("--pitch", type=float, default=18, help="degrees from above")
    parser.add_argument("--shutter", type=float, default=0.5, help="share of a frame in which it is open; 0: no motion blur")
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    return parser.parse_args(words)


def corners(collection):
    """Two corners of the box around all fragments in all frames, [m]."""
    points = [
        thing.matrix_world @ Vector(corner)
        for thing in collection.all_objects
        if "_collider" not in thing.name
        for corner in thing.bound_box
    ]
    return [Vector([choose(point[axis] for point in points) for axis in range(3)]) for choose in (min, max)]


def set_stage(scene, low, high, options):
    """A camera that sees the box, lights, and a backdrop behind it. The drawing lies in the x-z plane and is seen from -y."""
    middle, size = (low + high) / 2, high - low
    radius = size.length / 2
    yaw, pitch = math.radians(options.yaw), math.radians(options.pitch)
    toward = Vector((-math.sin(yaw) * math.cos(pitch), -math.cos(yaw) * math.cos(pitch), math.sin(pitch)))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.lens = 60
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.rotation_euler = toward.to_track_quat("Z", "Y").to_euler()
    aspect = min(1.0, max(0.4, size.z / max(size.x, 1e-9)))
    scene.render.resolution_x = options.size // 2 * 2
    scene.render.resolution_y = int(options.size * (0.15 + 0.85 * aspect)) // 2 * 2
    narrow = min(1.0, scene.render.resolution_y / scene.render.resolution_x)
    distance = 0.78 * radius / math.sin(math.atan(narrow * camera.data.sensor_width / 2 / camera.data.lens))
    camera.location = middle + distance * toward
    camera.data.clip_start, camera.data.clip_end = distance / 100, distance * 100
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle = 2.2, math.radians(8)
    sun.rotation_euler = Vector((-0.5, -0.9, 0.8)).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(sun)
    world = scene.world or bpy.data.worlds.new("world")
    scene.world = world
    if world.node_tree is None:
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.75, 0.82, 0.9, 1.0)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.55
    reach = 40 * radius
    behind = middle.y + 0.5 * size.y + 0.6 * radius
    backdrop = bpy.data.meshes.new("backdrop")
    backdrop.from_pydata(
        [(middle.x + i * reach, behind, middle.z + j * reach) for i, j in [(-1, -1), (1, -1), (1, 1), (-1, 1)]],
        [], [(0, 1, 2, 3)],
    )
    paint = bpy.data.materials.new("backdrop")
    if paint.node_tree is None:
        paint.use_nodes = True
    paint.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.30, 0.33, 0.37, 1.0)
    backdrop.materials.append(paint)
    scene.collection.objects.link(bpy.data.objects.new("backdrop", backdrop))


def set_renderer(scene, options):
    scene.render.engine = "CYCLES"
    scene.cycles.samples = options.samples
    scene.cycles.use_denoising = True
    scene.cycles.seed = 0
    scene.cycles.transmission_bounces = 12
    scene.render.use_motion_blur = options.shutter > 0
    if options.shutter > 0:
        scene.render.motion_blur_shutter = options.shutter
    scene.view_settings.view_transform = "Standard"


def main():
    options = arguments()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    # Cycles is an add-on of its own in Blender as a module.
    bpy.ops.preferences.addon_enable(module="cycles")
    try:
        collection, run = import_run(options.run, per_fragment=False, look=options.look, frames=options.frames)
    except NotReadable as problem:
        sys.exit(str(problem))
    if not collection.all_objects:
        sys.exit(f"{options.run} has none of these frames; it has {min(run.cracked)}-{max(run.cracked)}")
    set_stage(scene, *corners(collection), options)
    set_renderer(scene, options)
    if options.mp4:
        image = scene.render.image_settings
        if hasattr(image, "media_type"):
            image.media_type = "VIDEO"
        image.file_format = "FFMPEG"
        scene.render.ffmpeg.format, scene.render.ffmpeg.codec = "MPEG4", "H264"
        scene.render.ffmpeg.constant_rate_factor = "HIGH"
        scene.render.filepath = str(options.mp4.resolve())
        bpy.ops.render.render(animation=True)
        print(f"wrote {options.mp4}")
        return
    ending = "jpg" if options.jpeg else "png"
    scene.render.image_settings.file_format = "JPEG" if options.jpeg else "PNG"
    scene.render.image_settings.quality = 85
    folder = (options.output or options.run / "render").resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for number in sorted(number for number in run.cracked if options.frames is None or number in options.frames):
        scene.frame_set(number)
        scene.render.filepath = str(folder / f"{run.name}.{number:04}.{ending}")
        bpy.ops.render.render(write_still=True)
        print(f"wrote {scene.render.filepath}", flush=True)


if __name__ == "__main__":
    main()

"""Runs as objects of a scene."""

import bpy

from .build_mesh import build_mesh
from .glb_file import read_glb
from .looks import shared_materials
from .run_folder import read_run


def import_run(path, per_fragment=True, set_scene=True, look="clay", frames=None, progress=lambda done, total: None):
    """Imports the run in a folder into a new collection, which it gives with the run.

    Each frame has objects of its own, because what cracks has other vertices from frame to frame; they are shown in their frame only,
    by keys. With `per_fragment` one object per fragment and frame, in a collection for each fragment; otherwise one object per
    frame that holds all of them, told apart by the attribute `piece`. With `set_scene` the scene gets the range of frames, the rate of
    playback and motion blur. `frames` are the numbers to import; all where it is None.
    """
    run = read_run(path)
    outside, inside, collider = shared_materials(look)
    collection = bpy.data.collections.new(run.name)
    bpy.context.scene.collection.children.link(collection)
    numbers = [number for number in sorted(run.cracked) if frames is None or number in frames]
    of_fragment = {}
    for done, (number, following) in enumerate(zip(numbers, [*numbers[1:], None])):
        span = (number, following, done == 0)
        parts = read_glb(run.cracked[number])
        if per_fragment:
            for part in parts:
                if part.name not in of_fragment:
                    of_fragment[part.name] = bpy.data.collections.new(part.name)
                    collection.children.link(of_fragment[part.name])
                thing = _object(f"{part.name}.{number:04}", [part], [outside, inside], of_fragment[part.name], span)
                thing["piece"] = part.piece
        elif parts:
            _object(f"{run.name}.{number:04}", parts, [outside, inside], collection, span)
        if number in run.colliders:
            walls = read_glb(run.colliders[number])
            if walls:
                _object(f"{run.name}_collider.{number:04}", walls, [collider, collider], collection, span)
        progress(done + 1, len(numbers))
    if set_scene and numbers:
        _set_scene(bpy.context.scene, numbers, run.playback)
    return collection, run


def _object(name, parts, materials, collection, span):
    """An object that is shown from its frame on, until the one that follows."""
    number, following, is_first = span
    thing = bpy.data.objects.new(name, build_mesh(name, parts, materials))
    collection.objects.link(thing)
    for path in ["hide_viewport", "hide_render"]:
        # Keys of what is true or false are held until the next one.
        keys = [] if is_first else [(number - 1, True)]
        keys += [(number, False)] + ([] if following is None else [(following, True)])
        for at, hidden in keys:
            setattr(thing, path, hidden)
            thing.keyframe_insert(path, frame=at)
    return thing


def _set_scene(scene, numbers, playback):
    scene.frame_start, scene.frame_end = numbers[0], numbers[-1]
    scene.render.fps = max(1, round(playback))
    scene.render.fps_base = scene.render.fps / playback
    scene.render.use_motion_blur = True
    scene.frame_set(numbers[0])

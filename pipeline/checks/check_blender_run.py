"""Imports whole runs with the extension in pipeline/blender and holds the scene against the list of meshes: in each frame the
fragments of that frame are shown and no other, each closed, with the two shared materials, UVs, and velocities in Blender's axes.

    target/ci/bpy/bin/python pipeline/checks/check_blender_run.py out/pull ...     # see check_blender.py for the module bpy

Truth: `manifest.json`, and the files themselves. Without bpy nothing is checked.
"""

import importlib.util
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
# LNOR_SPACE_TRIGO_THRESHOLD in Blender's mesh_normals.cc: cosine of .8 degrees.
ALIKE = 1 - 1e-4


def shown(scene, number):
    """The mesh objects that are visible in a frame, for view and for render."""
    scene.frame_set(number)
    things = [thing for thing in scene.objects if thing.type == "MESH" and "_collider" not in thing.name]
    seen, rendered = ([t for t in things if not getattr(t, path)] for path in ["hide_viewport", "hide_render"])
    assert seen == rendered, f"frame {number}: view and render differ"
    return seen


def column(collection, name, width, kind="float32"):
    array = numpy.empty(len(collection) * width, kind)
    collection.foreach_get(name, array)
    return array.reshape(-1, width)


def worst_normal(found, expected, vertex):
    """How far normals of corners are off. Blender makes one of two at a vertex that are ALIKE: either will do."""
    off = numpy.abs(found - expected).max(axis=1)
    for corner in numpy.nonzero(off > 1e-3)[0]:
        beside = expected[vertex == vertex[corner]]
        alike = beside[beside @ expected[corner] > ALIKE]
        off[corner] = numpy.abs(alike - found[corner]).max(axis=1).min()
    return off.max()


def check_mesh(mesh, parts):
    """That a mesh is closed and has what its parts carry."""
    faces = numpy.sort(column(mesh.loops, "vertex_index", 1, "int32").reshape(-1, 3), axis=1)
    edges = numpy.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [0, 2]]])
    counts = numpy.unique(edges, axis=0, return_counts=True)[1]
    assert (counts == 2).all(), f"{mesh.name}: {(counts != 2).sum()} edges do not have two faces"
    assert len(faces) == sum(len(part.triangles) for part in parts), f"{mesh.name}: triangles are missing"
    assert [m.name for m in mesh.materials] == ["fissure outside", "fissure inside"], mesh.name
    inside = numpy.concatenate([part.is_inside for part in parts])
    assert (column(mesh.polygons, "material_index", 1, "int32")[:, 0] == inside).all(), f"{mesh.name}: materials differ"
    check_asked_for(mesh, parts)
    corners = numpy.concatenate([turned(part.normals)[part.triangles.reshape(-1)] for part in parts])
    vertex = column(mesh.loops, "vertex_index", 1, "int32")[:, 0]
    worst = worst_normal(column(mesh.corner_normals, "vector", 3), corners, vertex)
    assert worst < 1e-3, f"{mesh.name}: normals differ by {worst}"
    # Velocity and place of each corner, whichever vertices were joined.
    velocity = column(mesh.attributes["velocity"].data, "vector", 3)[vertex]
    expected = numpy.concatenate([turned(part.velocities)[part.triangles.reshape(-1)] for part in parts])
    size = max(1e-12, numpy.abs(expected).max())
    assert numpy.median(numpy.abs(velocity - expected)) <= 1e-6 * size, f"{mesh.name}: velocities differ"


def check_asked_for(mesh, parts):
    """UV maps, and what crack walls tell, corner by corner."""
    def corners(name, width):
        of_parts = [(part.triangles.reshape(-1), getattr(part, name)) for part in parts]
        return numpy.concatenate([numpy.zeros((len(c), width)) if v is None else v[c] for c, v in of_parts])

    expected = {"UVMap": corners("texture", 2)}
    if any(part.metres is not None for part in parts):
        expected["metres"] = corners("metres", 2)
    assert [layer.name for layer in mesh.uv_layers] == list(expected), mesh.name
    for layer in mesh.uv_layers:
        found, wanted = column(layer.uv, "vector", 2), expected[layer.name] * [1, -1] + [0, 1]
        assert numpy.abs(found - wanted).max() <= 1e-6 * max(1, numpy.abs(wanted).max()), f"{mesh.name}: {layer.name} differs"
    told = any(part.crack is not None for part in parts)
    assert all((name in mesh.attributes) == told for name in CRACK), f"{mesh.name}: what walls tell"
    for name, wanted in zip(CRACK, corners("crack", 3).T if told else []):
        assert (column(mesh.attributes[name].data, "value", 1)[:, 0] == wanted).all(), f"{mesh.name}: {name} differs"


def check(path, per_fragment):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    collection, run = import_run(path, per_fragment=per_fragment)
    scene = bpy.context.scene
    listed = json.loads((path / "manifest.json").read_text())["files"]
    pieces = {f["frame"]: f["pieces"] for f in listed if f["part"] == "cracked" and f["format"] == "glb"}
    assert (scene.frame_start, scene.frame_end) == (min(pieces), max(pieces))
    assert abs(scene.render.fps / scene.render.fps_base / run.playback - 1) < 1e-6
    for number, count in pieces.items():
        things = shown(scene, number)
        assert len(things) == (count if per_fragment else min(count, 1)), f"{run.name}, frame {number}: {len(things)} of {count}"
        parts = read_glb(run.cracked[number])
        by_name = {f"{part.name}.{number:04}": [part] for part in parts} if per_fragment else {f"{run.name}.{number:04}": parts}
        for thing in things:
            check_mesh(thing.data, by_name[thing.name])
    assert len(bpy.data.materials) == 3, [material.name for material in bpy.data.materials]
    return len(pieces), len(collection.all_objects)


def main(arguments):
    if not arguments:
        sys.exit("usage: check_blender_run.py RUN ...")
    for path in map(pathlib.Path, arguments):
        for per_fragment in [True, False]:
            frames, objects = check(path, per_fragment)
            kind = "fragment" if per_fragment else "frame"
            print(f"{path}: {frames} frames, {objects} objects, one per {kind}: as the files say")


if __name__ == "__main__":
    if importlib.util.find_spec("bpy") is None:
        print("skipped: Blender's module bpy is not installed here; see the head of check_blender.py")
        sys.exit()
    import bpy
    import numpy

    sys.path.insert(0, str(ROOT / "pipeline" / "blender"))
    from fissure_run.build_mesh import CRACK, turned
    from fissure_run.glb_file import read_glb
    from fissure_run.import_run import import_run

    main(sys.argv[1:])

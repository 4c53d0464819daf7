"""Imports mesh files with Blender's own importers and holds what arrives against what the files say.

    python3.11 -m venv target/ci/bpy && target/ci/bpy/bin/pip install bpy==5.0.1   # Blender as a module, 821 MB
    target/ci/bpy/bin/python pipeline/checks/check_blender.py out/pull ...         # files, or folders of them

Blender's glTF importer walks through sets whose order changes from process to process: what works once may fail the next
time. So each file is imported in 16 fresh processes, each with another PYTHONHASHSEED. Compared are, of GLB files, the
objects with their names and piece numbers, positions, triangles, the material of each triangle, texture coordinates,
normals, velocities and what crack walls tell; of PLY files positions, triangles and attributes. Without bpy nothing is checked.
"""

import importlib.util
import json
import os
import pathlib
import subprocess
import sys

SEEDS = range(16)
# Blender keeps normals as two angles of 16 bits: away from the normal that a corner would have, and around that.
NORMAL_TOLERANCE = 1e-3
# Where the second one has a cosine above .9999 Blender keeps zero.
ROUNDED_TURN = 0.01415
TEXTURE_TOLERANCE = 1e-6
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}
TYPES = {5125: "<u4", 5126: "<f4"}
IMPORT = "--import"


class Glb:
    """A GLB file as it is written: its document, and its accessors as arrays."""

    def __init__(self, path):
        content = path.read_bytes()
        length = int.from_bytes(content[12:16], "little")
        self.document = json.loads(content[20 : 20 + length])
        self.binary = content[20 + length + 8 :]

    def array(self, index):
        accessor = self.document["accessors"][index]
        start = self.document["bufferViews"][accessor["bufferView"]].get("byteOffset", 0)
        width = COMPONENTS[accessor["type"]]
        values = numpy.frombuffer(self.binary, TYPES[accessor["componentType"]], accessor["count"] * width, start)
        return values.reshape(-1, width)

    def attribute(self, primitive, name):
        """One of a primitive; zeros where only others of its mesh have it."""
        attributes = primitive["attributes"]
        return self.array(attributes[name]) if name in attributes else numpy.zeros_like(self.array(attributes["POSITION"]))

    def objects(self):
        """Name, extras and primitives of each node with a mesh; attributes of all primitives joined, as an importer joins them."""
        for node in self.document.get("nodes", []):
            if "mesh" not in node:
                continue
            primitives = self.document["meshes"][node["mesh"]]["primitives"]
            names = dict.fromkeys(name for primitive in primitives for name in primitive["attributes"])
            joined = {name: numpy.concatenate([self.attribute(p, name) for p in primitives]) for name in names}
            first, triangles, materials = 0, [], []
            for primitive in primitives:
                if "indices" in primitive:
                    corners = self.array(primitive["indices"]).reshape(-1, 3)
                    triangles.append(corners + first)
                    material = self.document["materials"][primitive["material"]]["name"]
                    materials += [material] * len(corners)
                first += self.document["accessors"][primitive["attributes"]["POSITION"]]["count"]
            triangles = numpy.concatenate(triangles) if triangles else numpy.empty((0, 3), int)
            yield node["name"], node.get("extras", {}), joined, triangles, materials


def turned(vectors):
    """From y up, as glTF has it, to z up, as Blender has it."""
    return numpy.stack([vectors[:, 0], -vectors[:, 2], vectors[:, 1]], 1)


def values(collection, name, width, kind="float32"):
    """A property of all items of a collection of Blender's, as an array with one row for each."""
    array = numpy.empty(len(collection) * width, kind)
    collection.foreach_get(name, array)
    return array.reshape(-1, width)


def same_mesh(mesh, positions, triangles):
    """Problems with the positions and triangles of a mesh that was imported."""
    if len(mesh.vertices) != len(positions) or len(mesh.polygons) != len(triangles):
        counts = f"{len(mesh.vertices)} vertices and {len(mesh.polygons)} triangles"
        return [f"{counts} instead of {len(positions)} and {len(triangles)}"]
    problems = []
    if not numpy.array_equal(values(mesh.vertices, "co", 3), positions):
        problems.append("positions differ")
    if not numpy.array_equal(values(mesh.loops, "vertex_index", 1, "int32").reshape(-1, 3), triangles):
        problems.append("triangles differ")
    return problems


def glb_problems(path):
    """Problems of one GLB file, imported into an empty Blender."""
    bpy.ops.import_scene.gltf(filepath=str(path))
    problems, names = [], []
    for name, extras, attributes, triangles, materials in Glb(path).objects():
        names.append(name)
        thing = bpy.data.objects.get(name)
        if thing is None:
            problems.append(f"the object {name} is missing")
            continue
        mesh, found = thing.data, same_mesh(thing.data, turned(attributes["POSITION"]), triangles)
        if "piece" not in extras or {key: thing.get(key) for key in extras} != extras:
            found.append(f"the properties {dict(thing.items())} for the extras {extras}, which should name the piece")
        for own in (name for name in attributes if name.startswith("_")):
            arrived = mesh.attributes.get(own)
            if arrived is None or (arrived.domain, arrived.data_type) != ("POINT", "FLOAT_VECTOR"):
                found.append(f"no {own}")
            elif not numpy.array_equal(values(arrived.data, "vector", 3), attributes[own]):
                found.append(f"{own} differs")
        if len(triangles) > 0 and not found:
            found += surface_problems(mesh, attributes, triangles, materials)
        problems += [f"{name}: {problem}" for problem in found]
    imported = sorted(thing.name for thing in bpy.data.objects if thing.type == "MESH")
    if imported != sorted(names):
        problems.append(f"objects {imported} instead of {sorted(names)}")
    return problems


def surface_problems(mesh, attributes, triangles, materials):
    """Problems with what triangles have and points do not."""
    problems, corners = [], triangles.reshape(-1)
    of_triangles = [mesh.materials[polygon.material_index].name for polygon in mesh.polygons]
    if of_triangles != materials:
        problems.append("materials differ")
    normal = turned(attributes["NORMAL"])[corners]
    off = numpy.abs(values(mesh.corner_normals, "vector", 3) - normal).max(axis=1)
    worst = (off - rounded_by(mesh, normal)).max()
    if worst > NORMAL_TOLERANCE:
        problems.append(f"normals differ by {worst}")
    sets = sorted(name for name in attributes if name.startswith("TEXCOORD_"))
    if len(mesh.uv_layers) != len(sets):
        return problems + [f"{len(mesh.uv_layers)} sets of texture coordinates instead of {len(sets)}"]
    for layer, name in zip(mesh.uv_layers, sets):
        texture = attributes[name][corners] * [1, -1] + [0, 1]
        # Coordinates in metres may be large.
        tolerance = TEXTURE_TOLERANCE * max(1.0, numpy.abs(texture).max())
        if (worst := numpy.abs(values(layer.uv, "vector", 2) - texture).max()) > tolerance:
            problems.append(f"texture coordinates {name} differ by {worst}")
    return problems


def rounded_by(mesh, normal):
    """How far each corner's normal may be off because Blender kept no turn around the normal of its own."""
    kept = mesh.attributes.get("custom_normal")
    if kept is None or kept.data_type != "INT16_2D":
        return numpy.zeros(len(normal))
    is_rounded = values(kept.data, "value", 2, "int32")[:, 1] == 0
    plain = mesh.copy()
    plain.attributes.remove(plain.attributes["custom_normal"])
    own = values(plain.corner_normals, "vector", 3)
    bpy.data.meshes.remove(plain)
    return numpy.where(is_rounded, ROUNDED_TURN * numpy.linalg.norm(numpy.cross(own, normal), axis=1), 0)


def ply_problems(path):
    """Problems of one PLY file, imported into an empty Blender."""
    head, _, body = path.read_bytes().partition(b"end_header\n")
    lines = [line.split() for line in head.decode().splitlines()]
    counts = {line[1]: int(line[2]) for line in lines if line[0] == "element"}
    names = [line[2] for line in lines if line[:2] == ["property", "float"]]
    if counts["vertex"] == 0:
        return []  # Blender refuses a PLY file without vertices; there is nothing in it that could be lost.
    rows = numpy.frombuffer(body, "<f4", counts["vertex"] * len(names)).reshape(-1, len(names))
    face = numpy.dtype([("count", "u1"), ("corners", "<i4", 3)])
    faces = numpy.frombuffer(body, face, counts.get("face", 0), rows.nbytes)
    bpy.ops.wm.ply_import(filepath=str(path))
    mesh = bpy.data.objects[0].data
    problems = same_mesh(mesh, rows[:, :3], faces["corners"])
    own = {"x", "y", "z", "nx", "ny", "nz", "s", "t"}
    for column, name in enumerate(names):
        if name not in own and not problems:
            attribute = mesh.attributes.get(name)
            if attribute is None or not numpy.array_equal(values(attribute.data, "value", 1)[:, 0], rows[:, column]):
                problems.append(f"the attribute {name} differs or is missing")
    return problems


def import_all(paths):
    """Imports each file into an empty Blender and prints its problems, one JSON string per line, on the original stdout."""
    report = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # Blender's own words go to standard error.
    for path in map(pathlib.Path, paths):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        try:
            problems = glb_problems(path) if path.suffix == ".glb" else ply_problems(path)
        except Exception as problem:  # an importer may fail in any way; all of them count
            problems = [f"{type(problem).__name__}: {last_error(str(problem))}"]
        for problem in problems:
            print(json.dumps(f"{path}: {problem}"), file=report, flush=True)


def last_error(text):
    """The line of a traceback that says what happened."""
    said = [line for line in text.splitlines() if line.split(":")[0].endswith("Error") and "Python" not in line]
    return said[-1] if said else text.strip()


def main(arguments):
    if not arguments:
        sys.exit("usage: check_blender.py FILE_OR_FOLDER ...")
    if importlib.util.find_spec("bpy") is None:
        print("skipped: Blender's module bpy is not installed here; see the head of check_blender.py")
        return
    paths = []
    for path in map(pathlib.Path, arguments):
        paths += sorted([*path.glob("*.glb"), *path.glob("*.ply")]) if path.is_dir() else [path]
    bad = 0
    for seed in SEEDS:
        command = [sys.executable, __file__, IMPORT, *map(str, paths)]
        result = subprocess.run(command, env={**os.environ, "PYTHONHASHSEED": str(seed)}, text=True, capture_output=True)
        problems = [json.loads(line) for line in result.stdout.splitlines()]
        if result.returncode != 0:
            problems.append(f"Blender ended with code {result.returncode}: {result.stderr.strip()[-500:]}")
        bad += bool(problems)
        for problem in problems[:5]:
            print(f"PYTHONHASHSEED={seed}: {problem}", file=sys.stderr)
        if len(problems) > 5:
            print(f"PYTHONHASHSEED={seed}: and {len(problems) - 5} more", file=sys.stderr)
    print(f"{len(paths)} files in {len(SEEDS)} processes of Blender: {bad} processes with problems")
    sys.exit(bad > 0 or not paths)


if __name__ == "__main__":
    if sys.argv[1:2] == [IMPORT]:
        import bpy
        import numpy

        import_all(sys.argv[2:])
    else:
        main(sys.argv[1:])

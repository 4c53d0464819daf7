"""Meshes of a GLB file as arrays. Knows no Blender."""

import json
from dataclasses import dataclass

import numpy

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}
TYPES = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}


class NotReadable(Exception):
    """A file that is none of Fissure's GLB files; says which and why."""


@dataclass
class MeshArrays:
    """One object of a file, in glTF's axes: y up, z towards the viewer of the drawing."""

    name: str
    piece: int
    positions: numpy.ndarray  # (vertices, 3) [m]
    normals: numpy.ndarray  # (vertices, 3)
    texture: numpy.ndarray  # (vertices, 2), v downwards
    velocities: numpy.ndarray  # (vertices, 3) [m per second of playback]
    metres: numpy.ndarray | None  # (vertices, 2), texture in metres, v downwards; where it was asked for
    crack: numpy.ndarray | None  # (vertices, 3), age [s], way to the mouth [m], K_I [Pa √m] of crack walls; where asked for
    triangles: numpy.ndarray  # (triangles, 3)
    is_inside: numpy.ndarray  # (triangles,) whether it is part of a crack wall


def read_glb(path):
    """The objects of a file that have triangles, in its order."""
    try:
        content = path.read_bytes()
        if content[:4] != b"glTF":
            raise NotReadable(f"{path} is no binary glTF file")
        length = int.from_bytes(content[12:16], "little")
        document, binary = json.loads(content[20 : 20 + length]), content[20 + length + 8 :]
        return list(_objects(document, binary))
    except OSError as problem:
        raise NotReadable(f"{path} cannot be read: {problem}") from problem
    except (KeyError, IndexError, ValueError, TypeError) as problem:
        raise NotReadable(f"{path} is damaged: {type(problem).__name__} {problem}") from problem


def _array(document, binary, index):
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    width = COMPONENTS[accessor["type"]]
    values = numpy.frombuffer(binary, TYPES[accessor["componentType"]], accessor["count"] * width, start)
    return values.reshape(-1, width)


def _objects(document, binary):
    materials = [material.get("name", "") for material in document.get("materials", [])]
    for node in document.get("nodes", []):
        if "mesh" not in node:
            continue
        parts = {"POSITION": [], "NORMAL": [], "TEXCOORD_0": [], "_VELOCITY": []}
        asked_for = {"TEXCOORD_1": [], "_CRACK": []}
        triangles, inside, first = [], [], 0
        for primitive in document["meshes"][node["mesh"]]["primitives"]:
            if "indices" not in primitive:
                continue
            for name, arrays in parts.items():
                arrays.append(_array(document, binary, primitive["attributes"][name]))
            for name, arrays in asked_for.items():
                index = primitive["attributes"].get(name)
                # What is no crack wall has no `_CRACK`.
                arrays.append(None if index is None else _array(document, binary, index))
            corners = _array(document, binary, primitive["indices"]).reshape(-1, 3).astype(numpy.int64)
            triangles.append(corners + first)
            inside.append(numpy.full(len(corners), materials[primitive["material"]] == "inside"))
            first += len(parts["POSITION"][-1])
        if triangles:
            joined = {name: numpy.concatenate(arrays) for name, arrays in parts.items()}
            counts = [len(places) for places in parts["POSITION"]]
            extra = {name: _joined(arrays, counts) for name, arrays in asked_for.items()}
            piece = int(node.get("extras", {}).get("piece", 0))
            yield MeshArrays(node["name"], piece, joined["POSITION"], joined["NORMAL"], joined["TEXCOORD_0"],
                             joined["_VELOCITY"], extra["TEXCOORD_1"], extra["_CRACK"], numpy.concatenate(triangles),
                             numpy.concatenate(inside))


def _joined(arrays, counts):
    """Arrays of some primitives as one, zero for those that have none; None where no primitive has one."""
    widths = {array.shape[1] for array in arrays if array is not None}
    if not widths:
        return None
    (width,) = widths
    return numpy.concatenate([numpy.zeros((n, width)) if array is None else array for array, n in zip(arrays, counts)])

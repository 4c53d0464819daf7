"""GLB files as Fissure writes them: their objects as tables."""

import json

import numpy

KINDS = {5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


class Glb:
    """The document of a GLB file, and its numbers as tables."""

    def __init__(self, path):
        data = path.read_bytes()
        length = int.from_bytes(data[12:16], "little")
        self.document = json.loads(data[20 : 20 + length])
        self.binary = data[28 + length :]

    def table(self, number):
        accessor = self.document["accessors"][number]
        view = self.document["bufferViews"][accessor["bufferView"]]
        width = WIDTHS[accessor["type"]]
        kind = KINDS[accessor["componentType"]]
        return numpy.frombuffer(self.binary, kind, accessor["count"] * width, view["byteOffset"]).reshape(-1, width)

    def objects(self):
        """name, fragment, vertices and triangles of each object"""
        for node in self.document["nodes"]:
            if "mesh" not in node:
                continue
            vertices, faces, first = [], [], 0
            for primitive in self.document["meshes"][node["mesh"]]["primitives"]:
                vertices.append(self.table(primitive["attributes"]["POSITION"]).astype(float))
                faces.append(self.table(primitive["indices"]).reshape(-1, 3).astype(int) + first)
                first += len(vertices[-1])
            yield node["name"], node.get("extras", {}).get("piece"), numpy.concatenate(vertices), numpy.concatenate(faces)

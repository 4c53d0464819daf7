"""A Blender mesh of arrays."""

import bpy
import numpy

# What crack walls tell, in the order of `MeshArrays.crack`.
CRACK = ("crack_age", "mouth_distance", "mode_1")


def turned(vectors):
    """From y up, as glTF has it, to z up, as Blender has it."""
    return numpy.stack([vectors[:, 0], -vectors[:, 2], vectors[:, 1]], 1)


def build_mesh(name, parts, materials):
    """A mesh of one or several `MeshArrays`, closed: vertices of an object that lie in one place are one. Its materials are those
    of outside and inside; attributes `velocity` of points, for motion blur, and `piece` of faces. Where they were asked for, the UV
    map `metres` and attributes of corners for what crack walls tell: points are shared with caps, which tell nothing."""
    points, velocities, triangles, inside, pieces, normals, texture = [], [], [], [], [], [], []
    first = 0
    for part in parts:
        # Adding zero makes -0 and 0 the same.
        places, at, of = numpy.unique(part.positions + 0.0, axis=0, return_index=True, return_inverse=True)
        corners = part.triangles.reshape(-1)
        points.append(places)
        velocities.append(part.velocities[at])
        triangles.append(of.reshape(-1)[part.triangles] + first)
        inside.append(part.is_inside)
        pieces.append(numpy.full(len(part.triangles), part.piece))
        normals.append(part.normals[corners])
        texture.append(part.texture[corners])
        first += len(places)
    points, triangles = turned(numpy.concatenate(points)), numpy.concatenate(triangles)

    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.astype(numpy.float32).ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", triangles.astype(numpy.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", numpy.arange(0, triangles.size, 3, dtype=numpy.int32))
    mesh.polygons.foreach_set("material_index", numpy.concatenate(inside).astype(numpy.int32))
    for material in materials:
        mesh.materials.append(material)
    _add_uv(mesh, "UVMap", numpy.concatenate(texture))
    if any(part.metres is not None for part in parts):
        _add_uv(mesh, "metres", numpy.concatenate([_corners(part, part.metres, 2) for part in parts]))
    if any(part.crack is not None for part in parts):
        told = numpy.concatenate([_corners(part, part.crack, len(CRACK)) for part in parts])
        for name, values in zip(CRACK, told.T):
            attribute = mesh.attributes.new(name, "FLOAT", "CORNER")
            attribute.data.foreach_set("value", numpy.ascontiguousarray(values, numpy.float32))
    # Blender and Cycles know this name: metres per second of playback, in Blender's own axes.
    velocity = mesh.attributes.new("velocity", "FLOAT_VECTOR", "POINT")
    velocity.data.foreach_set("vector", turned(numpy.concatenate(velocities)).astype(numpy.float32).ravel())
    piece = mesh.attributes.new("piece", "INT", "FACE")
    piece.data.foreach_set("value", numpy.concatenate(pieces).astype(numpy.int32))
    mesh.update(calc_edges=True)
    mesh.normals_split_custom_set(turned(numpy.concatenate(normals)))
    return mesh


def _add_uv(mesh, name, texture):
    """A UV map; v is upwards in Blender."""
    layer = mesh.uv_layers.new(name=name, do_init=False)
    layer.uv.foreach_set("vector", (texture * [1, -1] + [0, 1]).astype(numpy.float32).ravel())


def _corners(part, values, width):
    """Values of the vertices of a part at the corners of its triangles; zero where it has none."""
    corners = part.triangles.reshape(-1)
    return numpy.zeros((len(corners), width)) if values is None else values[corners]

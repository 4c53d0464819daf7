"""Materials that all objects of all runs share."""

import bpy

OUTSIDE, INSIDE, COLLIDER = "fissure outside", "fissure inside", "fissure collider"


def shared_materials(look="clay"):
    """The materials of outside, of crack walls and of colliders. Those that are there stay as they are."""
    made = []
    for name, paint in [(OUTSIDE, LOOKS[look][0]), (INSIDE, LOOKS[look][1]), (COLLIDER, _floor)]:
        material = bpy.data.materials.get(name)
        if material is None:
            material = bpy.data.materials.new(name)
            if material.node_tree is None:
                material.use_nodes = True
            paint(material)
        made.append(material)
    return made


def apply_look(look):
    """Paints the materials anew, whatever was done to them."""
    for material, paint in zip(shared_materials(look), [*LOOKS[look], _floor]):
        paint(material)


def _principled(material, color, roughness, **inputs):
    """A material of one Principled BSDF; gives its node."""
    nodes = material.node_tree.nodes
    nodes.clear()
    shader, output = nodes.new("ShaderNodeBsdfPrincipled"), nodes.new("ShaderNodeOutputMaterial")
    output.location = (300, 0)
    material.node_tree.links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    for name, value in inputs.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    material.diffuse_color = (*color, 1.0)
    return shader


def _grain(material, shader, size, dark, light, strength):
    """Colour and bumps of noise; `size` is that of a grain, as a share of the texture, which does not swim."""
    tree = material.node_tree
    place, noise = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeTexNoise")
    ramp, bump = tree.nodes.new("ShaderNodeValToRGB"), tree.nodes.new("ShaderNodeBump")
    for node, x in [(place, -1100), (noise, -900), (ramp, -600), (bump, -300)]:
        node.location = (x, -100)
    noise.inputs["Scale"].default_value = 1.0 / size
    noise.inputs["Detail"].default_value = 8.0
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.35, 0.65
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (*dark, 1.0), (*light, 1.0)
    bump.inputs["Strength"].default_value = strength
    bump.inputs["Distance"].default_value = 0.02
    tree.links.new(place.outputs["UV"], noise.inputs["Vector"])
    tree.links.new(noise.outputs["Fac"], ramp.inputs["Fac"])
    tree.links.new(ramp.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(noise.outputs["Fac"], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])


def _glass_outside(material):
    _principled(material, (0.90, 0.98, 0.95), 0.0, Transmission_Weight=1.0, IOR=1.5)


def _glass_inside(material):
    _principled(material, (0.72, 0.93, 0.85), 0.12, Transmission_Weight=1.0, IOR=1.5)


def _stone_outside(material):
    shader = _principled(material, (0.42, 0.40, 0.37), 0.8)
    _grain(material, shader, 0.008, (0.26, 0.25, 0.24), (0.50, 0.48, 0.44), 0.3)


def _stone_inside(material):
    shader = _principled(material, (0.6, 0.57, 0.52), 0.95)
    _grain(material, shader, 0.004, (0.48, 0.45, 0.40), (0.72, 0.69, 0.62), 0.8)


def _clay_outside(material):
    _principled(material, (0.62, 0.66, 0.70), 0.7)


def _clay_inside(material):
    _principled(material, (0.80, 0.25, 0.08), 0.8)


def _floor(material):
    _principled(material, (0.30, 0.30, 0.30), 0.9)


# Outside and crack walls.
LOOKS = {
    "clay": (_clay_outside, _clay_inside),
    "glass": (_glass_outside, _glass_inside),
    "stone": (_stone_outside, _stone_inside),
}

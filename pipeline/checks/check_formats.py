"""Holds PLY, USD, VTK, OBJ and SVG files of a run against its GLB files and these against its take.

    pip install numpy safetensors usd-core vtk meshio trimesh
    python check_formats.py OUT/NAME.take FOLDER

FOLDER holds the files of `fissure post OUT/NAME.take --formats glb,ply,obj,usda,vtk,svg --parts cracked,particles,faces
--output FOLDER`. In every frame that each format has:

- USD: the stage over all frames opens, and its points, normals, velocities and materials are those of the GLB file, to
  the bit, and texture coordinates upwards; a fragment that is not there yet has no points; extents hold the points; a
  file of a frame by itself says the same.
- Where crack walls tell how they came about (`--set output.attributes=["crack_age","mouth_distance","mode_1"]`), ages and
  K_I of each wall lie within those of the take, and distances within its longest way; PLY, USD and VTK files say the same as
  the GLB file, to the bit, and PLY and VTK nothing on other surfaces.
- PLY: places, normals, velocities and triangles are those of the GLB file, to the bit, turned so that the axis up is that
  of the scene, texture coordinates upwards, and fragments and materials of the same vertices.
- VTK: its own reader reads surfaces with as many triangles as the manifest says, and of its volume within 1e-5 (which
  the reader sums in single precision); it and meshio read the particles of the take, to the bit, and their mass in all is density times area times thickness; the list names the times.
- OBJ: trimesh reads each object, of the volume of the GLB file within 1e-6, and closed.
- SVG: the fragments have the area of the manifest within 1e-6.
"""

import json
import pathlib
import re
import sys
import xml.etree.ElementTree

import meshio
import numpy
import trimesh
import vtk
from glb import Glb
from pxr import Usd, UsdGeom, UsdShade
from safetensors.numpy import load_file
from vtk.util.numpy_support import vtk_to_numpy

VTK_VOLUME = 1e-5
# A mitre of a bevel lies twice its width in at most.
MITRE = 2.0
RELATIVE = 1e-6
ATTRIBUTES = ("crack_age", "mouth_distance", "mode_1")


def primitives(path):
    """(object, material) -> attributes of each primitive of a GLB file."""
    glb = Glb(path)
    names = [material["name"] for material in glb.document.get("materials", [])]
    found = {}
    for node in glb.document["nodes"]:
        for primitive in glb.document["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            material = names[primitive["material"]] if "material" in primitive else None
            arrays = {name: glb.table(number) for name, number in primitive["attributes"].items()}
            if "indices" in primitive:
                arrays["indices"] = glb.table(primitive["indices"]).reshape(-1)
            found[node["name"], material] = arrays
    return found


def history_problems(found, frame):
    """Problems of what the walls of one GLB file tell, against the frame of the take."""
    told = [arrays["_CRACK"] for arrays in found.values() if "_CRACK" in arrays]
    if not told:
        return
    ages, ways, modes = numpy.concatenate(told).T
    times, known = frame["cracks.formed_time"], frame["cracks.formed_mode_1"]
    youngest, oldest = frame["frame.time"][0] - times.max(), frame["frame.time"][0] - times.min()
    room = RELATIVE * max(oldest, 1e-30)
    if ages.min() < max(youngest, 0.0) - room or ages.max() > oldest + room:
        yield f"ages from {ages.min()} to {ages.max()} for {youngest} to {oldest}"
    if modes.min() < min(known.min(), 0.0) * (1 + RELATIVE) or modes.max() > known.max() * (1 + RELATIVE):
        yield f"K_I from {modes.min()} to {modes.max()} for {known.min()} to {known.max()}"
    steps = numpy.linalg.norm(numpy.diff(frame["cracks.rest"], axis=0), axis=1)
    ends = frame["cracks.offset"][1:-1]
    longest = numpy.delete(steps, ends - 1).sum()
    if ways.min() < 0 or ways.max() > longest * (1 + RELATIVE):
        yield f"distances from {ways.min()} to {ways.max()} along cracks of {longest} in all"


def usd_problems(stage, frame, expected):
    """Problems of one frame of a stage."""
    problems, missing = [], set(expected)
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.PointBased):
            continue
        shape = UsdGeom.PointBased(prim)
        read = lambda attribute: numpy.array(attribute.Get(frame) or [])
        points = read(shape.GetPointsAttr())
        if len(points) == 0:
            continue
        material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        key = prim.GetParent().GetDisplayName(), material.GetPrim().GetName() if material else None
        if key not in expected:
            problems.append(f"{key} is not in the GLB file")
            continue
        missing.discard(key)
        want = expected[key]
        found = {"POSITION": points, "_VELOCITY": read(shape.GetVelocitiesAttr())}
        if "indices" in want:
            mesh = UsdGeom.Mesh(prim)
            found["NORMAL"] = read(mesh.GetNormalsAttr())
            found["indices"] = read(mesh.GetFaceVertexIndicesAttr())
            found["TEXCOORD_0"] = read(UsdGeom.PrimvarsAPI(prim).GetPrimvar("st"))
            if (metres := UsdGeom.PrimvarsAPI(prim).GetPrimvar("st1")).HasValue():
                found["TEXCOORD_1"] = read(metres)
            told = [UsdGeom.PrimvarsAPI(prim).GetPrimvar(name) for name in ATTRIBUTES]
            if any(one.HasValue() for one in told):
                zeros = numpy.zeros(len(points), "float32")
                found["_CRACK"] = numpy.stack([read(one) if one.HasValue() else zeros for one in told], 1)
                if "_CRACK" not in want or {one.GetInterpolation() for one in told if one.HasValue()} != {"vertex"}:
                    problems.append(f"{key}: tells of a crack where the GLB file does not, or not at each vertex")
                    continue
            sets = [name for name in want if name.startswith("TEXCOORD_")]
            want = {**want, **{name: [0, 1] + want[name] * [1, -1] for name in sets}}
            if lost := (set(sets) | ({"_CRACK"} & set(want))) - set(found):
                problems.append(f"{key}: {sorted(lost)} are missing")
            if set(read(mesh.GetFaceVertexCountsAttr())) != {3} or mesh.GetNormalsInterpolation() != "vertex":
                problems.append(f"{key}: no triangles with a normal for each vertex")
        for name, values in found.items():
            # 1 − (1 − v) is not v to the bit.
            tolerance = 1e-7 * max(1.0, numpy.abs(want[name]).max()) if name.startswith("TEXCOORD_") else 0.0
            if values.shape != want[name].shape or numpy.abs(values - want[name]).max() > tolerance:
                problems.append(f"{key}: {name} differs")
        low, high = read(shape.GetExtentAttr())
        if (points < low).any() or (points > high).any():
            problems.append(f"{key}: the extent does not hold the points")
    return problems + [f"{key} is missing" for key in missing]


def check_usd(folder, records, sequences):
    for sequence in sequences:
        if sequence["file"].endswith(".clips.usda"):
            continue
        stage = Usd.Stage.Open(str(folder / sequence["file"]))
        own = [record for record in records if record["part"] == sequence["part"]]
        if (stage.GetStartTimeCode(), stage.GetEndTimeCode()) != (own[0]["frame"], own[-1]["frame"]):
            yield sequence["file"], "plays other frames"
        if UsdGeom.GetStageUpAxis(stage) != "Y" or UsdGeom.GetStageMetersPerUnit(stage) != 1:
            yield sequence["file"], "is not in metres, y up"
        for record in own:
            expected = primitives((folder / record["file"]).with_suffix(".glb"))
            for problem in usd_problems(stage, record["frame"], expected):
                yield sequence["file"], f"frame {record['frame']}: {problem}"
            alone = Usd.Stage.Open(str(folder / record["file"]))
            for problem in usd_problems(alone, record["frame"], expected):
                yield record["file"], problem


def mass_per_thickness(take):
    """Density times area of all bodies of a take [kg/m]; none where some are of several materials or not all is held."""
    scene = json.loads((take / "manifest.json").read_text())["scene"]
    if scene["take"]["particles"] != "full" or any(body["inclusions"] for body in scene["bodies"]):
        return None

    def area(ring):
        x, y = numpy.array(ring, float).T
        return 0.5 * float(numpy.sum(x * numpy.roll(y, -1) - y * numpy.roll(x, -1)))

    def mass(body):
        region = body["region"]
        return scene["materials"][body["material"]]["density"] * sum(map(area, [region["exterior"], *region["holes"]]))

    return sum(map(mass, scene["bodies"]))


def check_vtk(folder, records, sequences, take, thickness):
    take_mass = mass_per_thickness(take)
    for sequence in sequences:
        sets = xml.etree.ElementTree.parse(folder / sequence["file"]).getroot().iter("DataSet")
        listed = [(float(one.get("timestep")), one.get("file")) for one in sets]
        if listed != [(r["time"], r["file"]) for r in records if r["part"] == sequence["part"]]:
            yield sequence["file"], "lists other frames"
    for record in records:
        path = str(folder / record["file"])
        is_grid = path.endswith(".vtu")
        reader = vtk.vtkXMLUnstructuredGridReader() if is_grid else vtk.vtkXMLPolyDataReader()
        reader.SetFileName(path)
        reader.Update()
        data = reader.GetOutput()
        if reader.GetErrorCode() or vtk_to_numpy(data.GetFieldData().GetArray("TimeValue"))[0] != record["time"]:
            yield record["file"], "cannot be read, or is of another time"
        elif is_grid:
            frame = load_file(take / f"frame.{record['frame']:04}.safetensors")
            by_meshio = meshio.read(path)
            stress = frame["particles.cauchy_stress"].reshape(-1, 4)
            expected = {
                "velocity": numpy.pad(frame["particles.velocity"], ((0, 0), (0, 1))),
                "cauchy_stress": numpy.stack([stress[:, 0], stress[:, 3], 0.5 * (stress[:, 1] + stress[:, 2])], 1),
                "deformation_gradient": frame["particles.deformation_gradient"].reshape(-1, 4),
                "piece": frame["particles.piece"],
            }
            if take_mass is not None:
                expected["mass"] = load_file(take / "particles.safetensors")["particles.mass"] * thickness
                if not abs(expected["mass"].sum() / take_mass / thickness - 1) <= RELATIVE:
                    yield record["file"], f"{expected['mass'].sum()} kg instead of {take_mass * thickness}"
            for name, values in expected.items():
                by_vtk = vtk_to_numpy(data.GetPointData().GetArray(name))
                if not (numpy.array_equal(by_vtk, values) and numpy.array_equal(by_meshio.point_data[name], values)):
                    yield record["file"], f"{name} differs"
            if not numpy.array_equal(by_meshio.points[:, :2], frame["particles.position"]):
                yield record["file"], "positions differ"
        else:
            if data.GetNumberOfPolys() != record["triangles"]:
                yield record["file"], f"{data.GetNumberOfPolys()} of {record['triangles']} triangles"
            if record["area"] > 0:
                solid = vtk.vtkMassProperties()
                solid.SetInputData(data)
                if abs(solid.GetVolume() / record["volume"] - 1) > VTK_VOLUME:
                    yield record["file"], f"volume {solid.GetVolume()} instead of {record['volume']}"
            of_glb = primitives((folder / record["file"]).with_suffix(".glb"))
            for problem in vtk_history_problems(data, of_glb):
                yield record["file"], problem


def vtk_history_problems(data, of_glb):
    """Problems of what a surface of a VTK file tells of crack walls, against the GLB file of the same."""
    arrays = {name: data.GetPointData().GetArray(name) for name in ATTRIBUTES}
    told = {name: vtk_to_numpy(array) for name, array in arrays.items() if array is not None}
    width = len(ATTRIBUTES)
    expected = [one.get("_CRACK", numpy.zeros((len(one["POSITION"]), width), "float32")) for one in of_glb.values()]
    expected = numpy.concatenate(expected) if expected else numpy.zeros((0, width), "float32")
    if not told:
        if any("_CRACK" in one for one in of_glb.values()):
            yield "tells nothing of crack walls"
        return
    for column, name in enumerate(ATTRIBUTES):
        if not numpy.array_equal(told.get(name, numpy.zeros(len(expected), "float32")), expected[:, column]):
            yield f"{name} differs"


def check_glb(folder, records, take):
    for record in records:
        frame = load_file(take / f"frame.{record['frame']:04}.safetensors")
        for problem in history_problems(primitives(folder / record["file"]), frame):
            yield record["file"], problem


def ply(path):
    """Properties of the vertices of a PLY file, and its triangles."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    lines = [line.split() for line in header.decode().splitlines()]
    counts = {line[1]: int(line[2]) for line in lines if line[0] == "element"}
    names = [line[2] for line in lines if line[:2] == ["property", "float"]]
    floats = counts["vertex"] * len(names)
    vertices = numpy.frombuffer(body, "<f4", floats).reshape(-1, len(names))
    faces = numpy.frombuffer(body, [("count", "u1"), ("corners", "<i4", 3)], counts.get("face", 0), 4 * floats)
    if (faces["count"] != 3).any() or 4 * floats + faces.nbytes != len(body):
        raise ValueError(f"{path}: no list of triangles")
    return dict(zip(names, vertices.T)), faces["corners"]


def ply_problems(path, of_glb, up):
    """Problems of a PLY file of solids, against the GLB file of the same: its vertices are in the same order."""
    found, faces = ply(path)
    if not of_glb:
        if len(faces):
            yield "shows something where the GLB file is empty"
        return
    # The viewer, who stands on +z where y is up, stands on −y where z is up.
    turned = lambda values: values if up == "y" else numpy.stack([values[:, 0], -values[:, 2], values[:, 1]], 1)
    all_of = lambda name: numpy.concatenate([one[name] for one in of_glb.values()])
    expected = {}
    for names, attribute in (("x y z", "POSITION"), ("nx ny nz", "NORMAL"), ("vx vy vz", "_VELOCITY")):
        expected |= dict(zip(names.split(), turned(all_of(attribute)).T))
    for names, attribute in (("s t", "TEXCOORD_0"), ("s1 t1", "TEXCOORD_1")):
        if attribute in next(iter(of_glb.values())):
            expected |= dict(zip(names.split(), ([0, 1] + all_of(attribute) * [1, -1]).T))
    sizes = [len(one["POSITION"]) for one in of_glb.values()]
    expected["slot"] = numpy.repeat([float(material == "inside") for _, material in of_glb], sizes)
    pieces = [int(re.search(r"_(\d+)$", name).group(1)) for name, _ in of_glb]
    expected["piece"] = numpy.repeat(pieces, sizes)
    nothing = numpy.zeros((1, len(ATTRIBUTES)), "float32")
    told = [one.get("_CRACK", nothing.repeat(size, 0)) for one, size in zip(of_glb.values(), sizes)]
    for name, values in zip(ATTRIBUTES, numpy.concatenate(told).T):
        # What was not asked for is no property; the GLB file has zeros there.
        if name in found or values.any():
            expected[name] = values
    if set(found) != set(expected):
        yield f"has {sorted(found)} instead of {sorted(expected)}"
    for name in set(found) & set(expected):
        # 1 − (1 − v) is not v to the bit.
        tolerance = 1e-7 * max(1.0, numpy.abs(expected[name]).max()) if name[0] in "st" and name != "slot" else 0.0
        if found[name].shape != expected[name].shape or numpy.abs(found[name] - expected[name]).max() > tolerance:
            yield f"{name} differs"
    firsts = numpy.concatenate([[0], numpy.cumsum(sizes)])
    triangles = [one["indices"].reshape(-1, 3).astype(int) + first for one, first in zip(of_glb.values(), firsts)]
    if not numpy.array_equal(faces, numpy.concatenate(triangles)):
        yield "triangles differ"


def check_ply(folder, records, take):
    up = json.loads((take / "manifest.json").read_text())["scene"]["output"]["up"]
    for record in records:
        of_glb = (folder / record["file"]).with_suffix(".glb")
        if record["triangles"] > 0 and of_glb.exists():
            for problem in ply_problems(folder / record["file"], primitives(of_glb), up):
                yield record["file"], problem


def check_obj(folder, records):
    for record in records:
        scene = trimesh.load_scene(folder / record["file"], process=False, split_objects=True, group_material=False)
        triangles = sum(len(mesh.faces) for mesh in scene.geometry.values() if hasattr(mesh, "faces"))
        if triangles != record["triangles"]:
            yield record["file"], f"trimesh reads {triangles} of {record['triangles']} triangles"
        names = re.findall(r"^o (.*)$", (folder / record["file"]).read_text(), re.M)
        if names != [one["name"] for one in record["objects"]]:
            yield record["file"], f"objects {names}"
        if record["area"] > 0:
            volume = sum(mesh.volume for mesh in scene.geometry.values())
            if not abs(volume / record["volume"] - 1) <= RELATIVE:
                yield record["file"], f"volume {volume} instead of {record['volume']}"
            for name, mesh in scene.geometry.items():
                # trimesh merges within 1e-8, whatever the size: the shortest side becomes 1.
                mesh.apply_scale(1 / mesh.extents.min())
                mesh.merge_vertices(merge_tex=True, merge_norm=True)
                if not mesh.is_watertight:
                    yield record["file"], f"{name} is open"


def check_svg(folder, records):
    for record in records:
        root = xml.etree.ElementTree.parse(folder / record["file"]).getroot()
        area = length = 0.0
        for path in root.find(".//*[@id='fragments']"):
            for ring in path.get("d").split("Z")[:-1]:
                x, y = numpy.array(re.findall(r"[ML](\S+) ([^ML]+)", ring), float).T / 1000
                # y down: what is counter-clockwise in the scene is clockwise here.
                area -= 0.5 * float(numpy.sum(x * numpy.roll(y, -1) - y * numpy.roll(x, -1)))
                length += float(numpy.hypot(numpy.roll(x, -1) - x, numpy.roll(y, -1) - y).sum())
        # Drawn are caps, which end where bevels begin.
        most = record["area"] * (1 + RELATIVE)
        if not record["area"] * (1 - RELATIVE) - MITRE * record.get("bevel", 0) * length <= area <= most:
            yield record["file"], f"area {area} instead of {record['area']}"


def main(take, folder):
    take, folder = pathlib.Path(take), pathlib.Path(folder)
    manifest = json.loads((folder / "manifest.json").read_text())

    def of(kind, name):
        return [record for record in manifest.get(kind, []) if record["format"] == name]

    # Particles have none; it is that of the solids beside them.
    thickness = max(record["thickness"] for record in manifest["files"])
    problems = [
        *check_glb(folder, of("files", "glb"), take),
        *check_ply(folder, of("files", "ply"), take),
        *check_usd(folder, of("files", "usda"), of("sequences", "usda")),
        *check_vtk(folder, of("files", "vtk"), of("sequences", "vtk"), take, thickness),
        *check_obj(folder, of("files", "obj")),
        *check_svg(folder, of("files", "svg")),
    ]
    for file, problem in problems:
        print(f"{file}: {problem}", file=sys.stderr)
    counts = ", ".join(f"{len(of('files', name))} {name}" for name in ("ply", "usda", "vtk", "obj", "svg"))
    print(f"{counts} and what goes with them: {len(problems)} problems")
    sys.exit(bool(problems))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: check_formats.py TAKE FOLDER")
    main(*sys.argv[1:])

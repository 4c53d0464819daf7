"""The entry in the menu, and where a panel would go: register it beside the operator."""

import pathlib

import bpy
from bpy_extras.io_utils import ImportHelper

from .glb_file import NotReadable
from .import_run import import_run
from .looks import LOOKS


class FISSURE_OT_import_run(bpy.types.Operator, ImportHelper):
    """Import all frames of a run of Fissure"""

    bl_idname = "fissure.import_run"
    bl_label = "Import Fissure Run"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".json"
    filter_glob: bpy.props.StringProperty(default="manifest.json;*.glb", options={"HIDDEN"})
    objects: bpy.props.EnumProperty(
        name="Objects",
        items=[
            ("FRAGMENTS", "One per fragment", "An object for each fragment in each frame, in a collection for each fragment"),
            ("FRAMES", "One per frame", "An object for each frame, fragments told apart by the attribute piece"),
        ],
    )
    look: bpy.props.EnumProperty(
        name="Look", items=[(look, look.capitalize(), f"Materials like {look}") for look in LOOKS]
    )
    set_scene: bpy.props.BoolProperty(
        name="Set scene", default=True, description="Frame range, frames per second and motion blur as the run wants them"
    )

    def execute(self, context):
        window = context.window_manager
        window.progress_begin(0, 1)
        try:
            collection, run = import_run(
                pathlib.Path(self.filepath), self.objects == "FRAGMENTS", self.set_scene, self.look,
                progress=lambda done, total: window.progress_update(done / total),
            )
        except NotReadable as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        finally:
            window.progress_end()
        self.report({"INFO"}, f"{run.name}: {len(run.cracked)} frames, {len(collection.all_objects)} objects")
        return {"FINISHED"}


def _menu(menu, context):
    menu.layout.operator(FISSURE_OT_import_run.bl_idname, text="Fissure run (manifest.json)")


def register():
    bpy.utils.register_class(FISSURE_OT_import_run)
    bpy.types.TOPBAR_MT_file_import.append(_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(_menu)
    bpy.utils.unregister_class(FISSURE_OT_import_run)

"""What a run has written. Knows no Blender."""

import json
import pathlib
from dataclasses import dataclass

from .glb_file import NotReadable

# Frames per second where a run does not say.
USUAL_PLAYBACK = 24.0


@dataclass
class RunFolder:
    """The GLB files of a run, by frame number."""

    name: str
    playback: float  # frames per second
    cracked: dict
    colliders: dict


def read_run(path):
    """The run in a folder, or the one whose `manifest.json` or mesh file is named."""
    path = pathlib.Path(path)
    folder = path if path.is_dir() else path.parent
    manifest = folder / "manifest.json"
    try:
        listed = json.loads(manifest.read_text())
        files = [file for file in listed["files"] if file["format"] == "glb"]
        name = listed["scene"]
        of_part = {
            part: {file["frame"]: folder / pathlib.PurePath(file["file"]).name for file in files if file["part"] == part}
            for part in ["cracked", "collider"]
        }
    except OSError as problem:
        raise NotReadable(f"{folder} holds no run: {problem}. Choose the folder that `fissure run` has written") from problem
    except (ValueError, KeyError, TypeError) as problem:
        raise NotReadable(f"{manifest} is no list of meshes of Fissure: {type(problem).__name__} {problem}") from problem
    if not of_part["cracked"]:
        raise NotReadable(f"{folder} has no GLB files; write them with `fissure post {folder} --formats glb`")
    return RunFolder(name, _playback(folder, name), of_part["cracked"], of_part["collider"])


def _playback(folder, name):
    """Frames per second as the take says, which lies beside the meshes unless it was moved."""
    try:
        frames = json.loads((folder / f"{name}.take" / "manifest.json").read_text())["scene"]["frames"]
        return float(frames.get("playback", USUAL_PLAYBACK))
    except (OSError, ValueError, KeyError, TypeError):
        return USUAL_PLAYBACK

"""Imports runs of Fissure: every fragment, in every frame, with shared materials and velocities for motion blur."""

from . import operators


def register():
    operators.register()


def unregister():
    operators.unregister()

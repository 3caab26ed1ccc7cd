"""The extension: one corridor from a Blender scene to a compared picture."""

"""One viewport: asks the studio for pictures of its own camera, and copies the newest one to the screen."""

import time
from dataclasses import replace

import bpy
import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d

from ..methods.contract import View
from ..methods.studio import Develop, Picture
from ..scene import Camera
from .overlays import DEVELOPS, OF_MOTION
from .stages import Stage, wake


class Viewport:
    """Draws under Blender's own context, by Blender's own means, what was drawn in ours."""

    def __init__(self) -> None:
        self._stage: Stage | None = None
        self._shown: Picture | None = None
        self._texture: gpu.types.GPUTexture | None = None
        self.copy_ms = 0.0

    def draw(self, engine: bpy.types.RenderEngine, context: bpy.types.Context, stage: Stage) -> None:
        """Show the newest picture over the whole region, and ask for what is still missing."""
        if self._stage is not stage:
            self.close()
            self._stage = stage
        scene, region = context.scene, context.region
        settings = scene.catoptric
        stage.viewers[region.as_pointer()] = self
        view = view_of(region, context.region_data, int(settings.scale))
        develop = _develop_of(stage, settings.overlay)
        self._ask(view, 1 if develop in OF_MOTION else int(settings.samples), develop)
        picture = stage.studio.picture(self)
        if picture is None:
            return
        start, is_new = time.perf_counter(), self._shown is not picture
        if is_new:
            self._texture, self._shown = _texture(picture.pixels), picture
        gpu.state.blend_set("ALPHA_PREMULT")
        engine.bind_display_space_shader(scene)
        draw_texture_2d(self._texture, (0, 0), region.width, region.height)
        engine.unbind_display_space_shader()
        gpu.state.blend_set("NONE")
        if is_new:
            self.copy_ms = 1e3 * (time.perf_counter() - start)

    def _ask(self, view: View, samples: int, develop: Develop) -> None:
        """A sample a pixel while anything moves, then a smooth picture."""
        picture = self._stage.studio.picture(self)
        is_new = picture is not None and (picture.act, picture.develop) == (self._stage.act, develop)
        if not is_new or not picture.view.shows_the_same(view):
            self._stage.studio.look(self, view, develop)
        elif picture.view.samples < samples:
            self._stage.studio.look(self, replace(view, samples=samples), develop)
        else:
            return
        wake()

    def close(self) -> None:
        """Ask for nothing more."""
        if self._stage is not None:
            self._stage.studio.leave(self)
            for region in [region for region, viewer in self._stage.viewers.items() if viewer is self]:
                del self._stage.viewers[region]


def view_of(region: bpy.types.Region, seen: bpy.types.RegionView3D, scale: int) -> View:
    """What a region of a viewport shows, at the screen's resolution over `scale`."""
    width, height = max(1, region.width // scale), max(1, region.height // scale)
    camera = Camera.of_matrices(np.array(seen.view_matrix), np.array(seen.window_matrix), width, height)
    return View(camera, width, height, samples=1)


def _develop_of(stage: Stage, overlay: str) -> Develop:
    """What turns a canvas into what `overlay` shows; the picture itself where there is nothing to hold it against."""
    if stage.reference is not None and overlay in {"SPLIT", "ERROR"}:
        return stage.reference.split if overlay == "SPLIT" else stage.reference.error
    return DEVELOPS.get(overlay, DEVELOPS["PICTURE"])


def _texture(pixels: np.ndarray) -> gpu.types.GPUTexture:
    height, width = pixels.shape[:2]
    data = gpu.types.Buffer("FLOAT", pixels.size, pixels)
    return gpu.types.GPUTexture((width, height), format="RGBA32F", data=data)

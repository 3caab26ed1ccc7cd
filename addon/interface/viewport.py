"""One viewport: asks the studio for pictures of its own camera, and copies the newest one to the screen."""

import time
from dataclasses import replace

import bpy
import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d

from ..methods.contract import View
from ..methods.pace import Pace
from ..methods.studio import Develop, Picture
from ..scene import Camera
from .overlays import DEVELOPS, OF_MOTION
from .stages import Stage, redraw_in, wake

AUTOMATIC = "AUTOMATIC"
"""The resolution that is whole at rest, and coarser while anything moves where whole pictures take long."""

_COARSEST = 2
"""Coarser ones gain little: Blender's own drawing takes longer."""

_REST_S = 0.2
"""Without a move, after which coarse pictures become whole."""


class Viewport:
    """Draws under Blender's own context, by Blender's own means, what was drawn in ours.

    `scale` is by what the sides of the screen were divided for what it shows, `copy_ms` what its way there took.
    """

    def __init__(self) -> None:
        self._stage: Stage | None = None
        self._shown: Picture | None = None
        self._texture: gpu.types.GPUTexture | None = None
        self._pace = Pace(_COARSEST)
        self._seen: tuple[View, int] | None = None
        self._moved = 0.0
        self.scale, self.copy_ms = 1, 0.0

    def draw(self, engine: bpy.types.RenderEngine, context: bpy.types.Context, stage: Stage) -> None:
        """Show the newest picture over the whole region, and ask for what is still missing."""
        if self._stage is not stage:
            self.close()
            self._stage = stage
        scene, region = context.scene, context.region
        settings = scene.catoptric
        stage.viewers[region.as_pointer()] = self
        develop = _develop_of(stage, settings.overlay)
        self._ask(context, develop)
        picture = stage.studio.picture(self)
        if picture is None:
            return
        start, is_new = time.perf_counter(), self._shown is not picture
        if is_new:
            self._texture, self._shown = _texture(picture.pixels), picture
            self.scale = _scale_of(picture, region)
            if picture.view.samples == 1:
                self._pace.took(self.scale, picture.time_ms["frame"] / 1e3)
        gpu.state.blend_set("ALPHA_PREMULT")
        engine.bind_display_space_shader(scene)
        draw_texture_2d(self._texture, (0, 0), region.width, region.height)
        engine.unbind_display_space_shader()
        gpu.state.blend_set("NONE")
        if is_new:
            self.copy_ms = 1e3 * (time.perf_counter() - start)

    def _ask(self, context: bpy.types.Context, develop: Develop) -> None:
        """Have the next picture drawn: coarse if the whole would take long, then whole, and at last smooth."""
        region, settings = context.region, context.scene.catoptric
        whole, samples = view_of(region, context.region_data, scale_at_rest(settings)), int(settings.samples)
        self._watch(whole)
        picture = self._stage.studio.picture(self)
        is_new = picture is not None and (picture.act, picture.develop) == (self._stage.act, develop)
        if not is_new or not is_of(picture, region, context.region_data):
            is_free = settings.scale == AUTOMATIC and develop in DEVELOPS.values() and develop not in OF_MOTION
            wanted = view_of(region, context.region_data, self._pace.scale) if is_free else whole
        elif not picture.view.shows_the_same(whole):
            if (left := self._moved + _REST_S - time.perf_counter()) > 0.0:
                redraw_in(left)
                return
            wanted = whole
        elif picture.view.samples < samples and develop not in OF_MOTION:
            wanted = replace(whole, samples=samples)
        else:
            return
        self._stage.studio.look(self, wanted, develop)
        wake()

    def _watch(self, view: View) -> None:
        """Note when anything has moved last."""
        now = view, self._stage.act
        if self._seen is None or self._seen[1] != now[1] or not self._seen[0].shows_the_same(view):
            self._seen, self._moved = now, time.perf_counter()

    def close(self) -> None:
        """Ask for nothing more."""
        if self._stage is not None:
            self._stage.studio.leave(self)
            for region in [region for region, viewer in self._stage.viewers.items() if viewer is self]:
                del self._stage.viewers[region]


def scale_at_rest(settings) -> int:
    """By what the sides of the screen are divided once nothing moves."""
    return 1 if settings.scale == AUTOMATIC else int(settings.scale)


def view_of(region: bpy.types.Region, seen: bpy.types.RegionView3D, scale: int) -> View:
    """What a region of a viewport shows, at the screen's resolution over `scale`."""
    width, height = max(1, region.width // scale), max(1, region.height // scale)
    camera = Camera.of_matrices(np.array(seen.view_matrix), np.array(seen.window_matrix), width, height)
    return View(camera, width, height, samples=1)


def is_of(picture: Picture, region: bpy.types.Region, seen: bpy.types.RegionView3D) -> bool:
    """Whether a picture is of what a region shows now, at any resolution."""
    return picture.view.shows_the_same(view_of(region, seen, _scale_of(picture, region)))


def _scale_of(picture: Picture, region: bpy.types.Region) -> int:
    return max(1, round(region.width / picture.view.width))


def _develop_of(stage: Stage, overlay: str) -> Develop:
    """What turns a canvas into what `overlay` shows; the picture itself where there is nothing to hold it against."""
    if stage.reference is not None and overlay in {"SPLIT", "ERROR"}:
        return stage.reference.split if overlay == "SPLIT" else stage.reference.error
    return DEVELOPS.get(overlay, DEVELOPS["PICTURE"])


def _texture(pixels: np.ndarray) -> gpu.types.GPUTexture:
    height, width = pixels.shape[:2]
    data = gpu.types.Buffer("FLOAT", pixels.size, pixels)
    return gpu.types.GPUTexture((width, height), format="RGBA32F", data=data)

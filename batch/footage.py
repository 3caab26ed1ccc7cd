"""The frames of a source, one after another, as far as they are alike read and lit once."""

from dataclasses import replace

from ..addon.cache import Cache
from ..addon.errors import SceneError
from ..addon.progress import Progress, silent
from ..addon.scene import Lighting, Scene, alike, only_seen_from_elsewhere, sharing
from .sources import Source

_LEAST_LIGHT = 32  # samples of a texel; denoised, and seen from every pixel around


def require_reflectors(scene: Scene) -> None:
    """Raise `SceneError` if nothing in the scene mirrors."""
    if not scene.reflectors:
        raise SceneError(
            f"{scene.name}: nothing reflects here; give an object a metallic or glossy material of low roughness"
        )


def lit(
    source: Source, scene: Scene, lighting: Lighting, cache: Cache, progress: Progress = silent, samples: int = 256
) -> Scene:
    """The scene with what `lighting` needs baked into it, as fine as suits a reference of `samples` a pixel."""
    has_lightmaps = any(instance.lightmap is not None for instance in scene.instances)
    if lighting is not Lighting.CYCLES or has_lightmaps:
        return scene
    if not source.needs_blender:
        raise SceneError(f"{source.path.name} holds no lightmaps: export it with --lighting cycles")
    from ..addon.blender.lightmap import bake_lightmaps

    quality = max(_LEAST_LIGHT, samples // 8)
    return bake_lightmaps(source.bpy_scene, scene, quality, cache=cache, progress=progress)


class Footage:
    """The frames of a source under one light. What stays from frame to frame is the same object in memory.

    Light that is baked is baked again only where more than the camera has changed: it is as fine as the first of
    those frames shows it.
    """

    def __init__(self, source: Source, lighting: Lighting, cache: Cache, samples: int) -> None:
        """Nothing is read yet; `samples` as of `lit`."""
        self.source = source
        self._lighting, self._cache, self._samples = lighting, cache, samples
        self._read: Scene | None = None
        self._unlit: Scene | None = None
        self._lit: Scene | None = None

    def read(self, frame: int, progress: Progress = silent) -> Scene:
        """The scene at `frame`, without baked light; Blender stays there. Raises `SceneError` where nothing mirrors."""
        self._read = self.source.scene(frame, progress, self._read)
        require_reflectors(self._read)
        return self._read

    def light(self, scene: Scene, progress: Progress = silent) -> Scene:
        """What was just read, with its light."""
        if self._lit is not None and only_seen_from_elsewhere(scene, self._unlit):
            return replace(self._lit, camera=scene.camera, frame=scene.frame)
        baked = lit(self.source, scene, self._lighting, self._cache, progress, self._samples)
        self._lit = baked if self._lit is None else sharing(baked, self._lit)
        self._unlit = scene
        return self._lit

    def first_change(self, frames: tuple[int, ...], progress: Progress = silent) -> int | None:
        """The first of `frames` that shows something else than the first one; None if all are alike."""
        start = self.read(frames[0])
        for number, frame in enumerate(frames[1:], start=1):
            progress("looking for what moves", number / len(frames))
            scene = self.read(frame)
            if not (only_seen_from_elsewhere(scene, start) and alike(scene.camera, start.camera)):
                return frame
        return None

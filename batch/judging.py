"""One frame of one scene, and what every picture of it is held against."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from ..addon.methods.contract import Frame, Method, Reuse, View
from ..addon.methods.registry import METHODS
from ..addon.metrics import Figures, error_maps, exposures_of, noise_maps
from ..addon.parameters import Value
from ..addon.progress import Progress, silent
from ..addon.scene import Lighting, Scene
from .pictures import image_paths, retraced_path, save_exr, save_images, save_mask
from .results import Images, Noise, Result, Reused, Samples, Times
from .sampling import WITHOUT_REFERENCE, supersampling

_WARMING = 0.0, 1e-3, 2e-3  # metres to the side


@dataclass(eq=False)
class Shot:
    """A scene under one light at one size, and the folder its pictures go to.

    `side` squared are the methods' samples a pixel. `reference` (H, W, 3) float32, `half`, the same
    made of one half of its samples, and how many these were are None where there is nothing to judge by; the last two
    also where a method, `against`, drew the reference. `mask` (H, W) bool, the pixels that show reflectors, comes with
    the first frame that a method renders. `one_of_many`: HDR-FLIP is left out, and the methods' pictures are kept in
    16 bits a channel.
    """

    name: str
    scene: Scene
    lighting: Lighting
    size: tuple[int, int]
    out: Path
    side: int = supersampling(WITHOUT_REFERENCE)
    reference: np.ndarray | None = None
    half: np.ndarray | None = None
    samples: int | None = None
    mask: np.ndarray | None = None
    against: str | None = None
    one_of_many: bool = False

    def take(self, method: Method, progress: Progress = silent) -> Frame:
        """The picture of a prepared method."""
        frame = method.render(View(self.scene.camera, *self.size, self.side), progress)
        if self.mask is None:
            self.mask = frame.reflectors >= 0.5
        return frame

    def warm_up(self, method: Method) -> None:
        """Have drivers compile what they put off until something is drawn, if there is but one sample to be timed.

        The pictures are of another size, so that no method takes anything over from them, and from several places
        near by, so that one which takes over from earlier pictures has done so. They are half as high: Mesa compiles
        programs anew for textures whose sides are no powers of two.
        """
        if self.side > 1:
            return
        width, height = self.size
        for step in _WARMING:
            aside = np.eye(4)
            aside[0, 3] = step
            near_by = replace(self.scene.camera, matrix=self.scene.camera.matrix @ aside)
            method.render(View(near_by, width, max(1, height // 2), 1))

    def images(self, method: str) -> Images:
        """Where the pictures of a method go."""
        return image_paths(self.name, self.scene.frame, str(self.lighting), method, self.against)

    def judge_by(self, reference: np.ndarray, half: np.ndarray, samples: int) -> None:
        """Take the reference, which the methods' samples follow, and save it in place of an older one."""
        self.reference, self.half, self.samples = reference, half, samples
        self.side = supersampling(samples)
        save_exr(self.out / self.images("").reference, reference, self._metadata("cycles"))

    def judges(self, method: str) -> bool:
        """Whether there is something to hold a method's picture against; not where that is its own."""
        return self.reference is not None and method != self.against

    def result(
        self,
        method: str,
        color: np.ndarray,
        settings: Mapping[str, Value],
        time_ms: Times,
        warnings: list[str],
        reuse: Reuse | None = None,
    ) -> Result:
        """Measure a picture (H, W, 3), save it and its error, and give its row; no figures without a reference."""
        images, judged = self.images(method), self.judges(method)
        over_reflectors, over_frame = Figures(int(self.mask.sum())), Figures(self.mask.size)
        if judged:
            errors = error_maps(color, self.reference, self._exposures, hdr=not self.one_of_many)
            over_reflectors, over_frame = errors.over(self.mask), errors.over()
            metadata = self._metadata(method)
            save_images(self.out, images, color, self.reference, errors.flip, metadata, self.one_of_many)
        else:
            images = replace(images, reference=None, flip=None)
            save_exr(self.out / images.method, color, self._metadata(method))
        if reuse is not None:
            images = replace(images, retraced=retraced_path(images))
            save_mask(self.out / images.retraced, reuse.retraced)
        return Result(
            scene=self.name,
            frame=self.scene.frame,
            method=method,
            lighting=str(self.lighting),
            width=self.size[0],
            height=self.size[1],
            settings=dict(settings),
            over_reflectors=over_reflectors,
            over_frame=over_frame,
            time_ms=time_ms,
            images=images,
            noise=self._noise,
            warnings=warnings,
            reuse=None if reuse is None else Reused(float(reuse.share), bool(reuse.is_key)),
            against=self.against if judged else None,
            samples=Samples(self.samples, self.side**2 if method in METHODS else None),
        )

    @cached_property
    def _exposures(self):
        return None if self.one_of_many else exposures_of(self.reference)

    @cached_property
    def _noise(self) -> Noise | None:
        """The reference's own error, from the two halves that it is the mean of."""
        if self.half is None:
            return None
        maps = noise_maps(self.half, 2 * self.reference - self.half, self._exposures, hdr=not self.one_of_many)
        return Noise(maps.over(self.mask), maps.over())

    def _metadata(self, method: str) -> dict[str, str]:
        return {
            "catoptric:scene": self.name,
            "catoptric:frame": str(self.scene.frame),
            "catoptric:method": method,
            "catoptric:lighting": str(self.lighting),
        }

"""Small comparisons, as `compare` would leave them, for the tests of results.json and of the page."""

import dataclasses
from functools import cache

import numpy as np
from catoptric.addon.metrics import error_maps, exposures_of, noise_maps
from catoptric.batch.pictures import image_paths, save_images
from catoptric.batch.results import Machine, Noise, Result, Results, Skipped, Times

WIDTH, HEIGHT = 48, 32
SOFTWARE = Machine("llvmpipe (LLVM 15.0.6, 256 bits)", "4.5 Mesa", "a processor", "5.2.3", "3.13.0")
HOSTILE = "</script><b>\"&'"


def scene_picture(shift=0.0):
    """A bright disc, brighter than white, on a gradient; `shift` moves what the disc shows."""
    y, x = np.mgrid[:HEIGHT, :WIDTH].astype(np.float32)
    picture = np.stack([x / WIDTH, y / HEIGHT, np.full_like(x, 0.2)], axis=-1)
    disc = (x - 24) ** 2 + (y - 16) ** 2 < 100
    picture[disc] = 1.5 + np.sin(x[disc] + shift)[:, None] * (1.0, 0.5, 0.2)
    return picture, disc


@cache
def compared_once(shift):
    """The error maps of `scene_picture(shift)` and the noise of its reference: FLIP is slow where cores are shared."""
    reference, _ = scene_picture()
    exposures = exposures_of(reference)
    maps = error_maps(scene_picture(shift)[0], reference, exposures)
    return maps, noise_maps(reference * 1.001, reference * 0.999, exposures)


def measured(directory, results, scene, method, shift, **changes):
    """Compare, write the pictures, and add the result: what `compare` does for each method."""
    (reference, disc), (color, _) = scene_picture(), scene_picture(shift)
    maps, noise = compared_once(shift)
    images = image_paths(scene, 1, "unlit", method)
    save_images(directory, images, color, reference, maps.flip, {"catoptric:method": method})
    result = Result(
        scene=scene,
        frame=1,
        method=method,
        lighting="unlit",
        width=WIDTH,
        height=HEIGHT,
        settings={"texels": 512, "threshold": 0.01, "exact": True, "filter": "linear"},
        over_reflectors=maps.over(disc),
        over_frame=maps.over(),
        time_ms=Times(bake=120.0, reflection=3.0 + shift, frame=9.0),
        images=images,
        noise=Noise(noise.over(disc), noise.over()),
    )
    results.add(dataclasses.replace(result, **changes))


def compared_in(directory):
    """Two scenes, three methods, one of them missing in the second; and where they lie."""
    results = Results("0.1.0", SOFTWARE, sources={"environment-map": "a source & more"})
    for scene in ("box", "ball"):
        measured(directory, results, scene, "environment-map", 1.5)
        measured(directory, results, scene, "layered-depth", 0.05)
    measured(directory, results, "box", HOSTILE, 0.7, warnings=[f"warned of {HOSTILE}"])
    results.skip(Skipped("ball", HOSTILE, f"a reason with {HOSTILE}", error=True))
    return results, directory

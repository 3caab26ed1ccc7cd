"""Framebuffers are wiped, whatever they hold."""

import numpy as np
from catoptric.addon.gl import call, clear, require

SIZE = (8, 4)


def wiped(scissor=None):
    context = require()
    ones = {"f4": np.ones((*SIZE[::-1], 4), np.float32), "u4": np.ones((*SIZE[::-1], 4), np.uint32)}
    textures = [context.texture(SIZE, 4, pixels, dtype=kind) for kind, pixels in ones.items()]
    depth = context.depth_texture(SIZE, np.zeros(SIZE[::-1], np.float32))
    target = context.framebuffer(textures, depth)
    target.scissor = scissor
    try:
        clear(target)
        kinds = (np.float32, np.uint32)
        colors = [np.frombuffer(one.read(), kind).reshape(4, 8, 4) for one, kind in zip(textures, kinds, strict=True)]
        return *colors, np.frombuffer(depth.read(), np.float32).reshape(4, 8)
    finally:
        for part in (target, *textures, depth):
            part.release()


def test_colours_become_0_and_depth_1():
    floats, integers, depth = call(wiped)
    assert not floats.any()
    assert not integers.any()
    assert (depth == 1.0).all()


def test_nothing_outside_of_the_scissor_is_touched():
    floats, integers, depth = call(wiped, (2, 1, 3, 2))
    inside = np.zeros((4, 8), bool)
    inside[1:3, 2:5] = True
    for color in (floats, integers):
        assert (color[~inside] == 1).all()
        assert not color[inside].any()
    assert np.array_equal(depth, inside)

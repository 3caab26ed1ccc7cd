"""Layered depth textures say how far they are within an object, and stop there when asked to."""

import numpy as np
import pytest
import trimesh
from catoptric.addon.baking.layered_depth import bake_instance, bake_layers
from catoptric.addon.cache import Cache
from catoptric.addon.drawing import Resident
from catoptric.addon.errors import Cancelled
from catoptric.addon.gl import call
from catoptric.addon.scene import Lighting

from .stage import looking, mesh_of, placed, scene_of

SHELLS = 5
"""Around each other, with room between: a line through the middle crosses twice as many surfaces."""


@pytest.fixture
def resident():
    shells = trimesh.util.concatenate(
        [trimesh.creation.icosphere(subdivisions=2, radius=1 + 0.2 * n) for n in range(SHELLS)]
    )
    parts = [(mesh_of(shells), placed(), False), (mesh_of(trimesh.creation.box()), placed((4, 0, 0)), False)]
    made = call(Resident, scene_of(parts, looking((0, -9, 1))), Lighting.UNLIT)
    yield made
    call(made.release)


@pytest.mark.parametrize("layers", [16, 2], ids=["whole", "cut"])
def test_every_pass_is_told(resident, layers):
    told = []
    call(bake_instance, resident, 0, 32, layers, lambda stage, fraction: told.append(fraction))
    passes = 2 * SHELLS if layers == 16 else 2 * 2 * layers
    assert len(told) == 3 * passes
    assert np.diff(told).min() >= 0.0
    assert len(set(told)) >= 0.9 * len(told)
    assert 0.0 < told[0] < 0.2
    assert told[-1] <= 1.0
    if layers == 16:
        assert told[-1] == pytest.approx(1.0, abs=1e-6)


def test_objects_share_the_way(resident):
    told = []
    settings = {"resolution": 32, "layers": 16}
    call(bake_layers, resident, settings, None, lambda stage, fraction: told.append(fraction))
    assert np.diff(told).min() >= 0.0
    assert 0.5 in told
    assert sum(0.0 < fraction < 0.5 for fraction in told) > 20
    assert told[-1] == 1.0


def test_a_stop_within_an_object_leaves_nothing_and_harms_nothing(resident, tmp_path):
    cache, settings = Cache(tmp_path), {"resolution": 32, "layers": 16}
    whole = call(bake_layers, resident, settings)

    def stop(stage, fraction):
        if fraction > 0.2:
            raise Cancelled

    with pytest.raises(Cancelled):
        call(bake_layers, resident, settings, cache, stop)
    assert cache.size() == 0
    again = call(bake_layers, resident, settings, cache)
    for one, other in zip(whole, again, strict=True):
        for name in ("+X", "-Y", "+Z"):
            for array in ("counts", "depths", "triangles", "colors", "normals"):
                np.testing.assert_array_equal(getattr(one.face(name), array), getattr(other.face(name), array))

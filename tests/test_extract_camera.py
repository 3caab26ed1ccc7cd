"""Camera and lamps, as Blender itself has them."""

import bpy
import numpy as np
import pytest
from catoptric.addon.blender.extract import extract
from catoptric.addon.errors import SceneError
from catoptric.addon.scene import LampKind
from catoptric.tests import blender_stage as stage
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st


@pytest.fixture
def scene():
    scene = stage.empty_scene()
    stage.add_camera(scene, (0, 0, 5), (0, 0, 0))
    return scene


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    kind=st.sampled_from(("PERSP", "ORTHO")),
    fit=st.sampled_from(("AUTO", "HORIZONTAL", "VERTICAL")),
    size=st.tuples(st.integers(4, 3000), st.integers(4, 3000)),
    aspect=st.tuples(st.floats(1, 3), st.floats(1, 3)),
    shift=st.tuples(st.floats(-2, 2), st.floats(-2, 2)),
    lens=st.floats(8, 300),
    sensor=st.tuples(st.floats(4, 60), st.floats(4, 60)),
    clip=st.tuples(st.floats(0.01, 1), st.floats(2, 1e4)),
)
def test_projection_is_blenders(scene, kind, fit, size, aspect, shift, lens, sensor, clip):
    data, render = scene.camera.data, scene.render
    data.type, data.sensor_fit, data.lens, data.ortho_scale = kind, fit, lens, lens / 10
    data.shift_x, data.shift_y = shift
    data.sensor_width, data.sensor_height = sensor
    data.clip_start, data.clip_end = clip
    render.resolution_x, render.resolution_y = size
    render.pixel_aspect_x, render.pixel_aspect_y = aspect
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera = extract(scene, depsgraph).camera
    blenders = scene.camera.calc_matrix_camera(
        depsgraph, x=size[0], y=size[1], scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y
    )
    expected = np.array(blenders)
    np.testing.assert_allclose(camera.projection(*size), expected, rtol=2e-5, atol=2e-5 * np.abs(expected[:2]).max())


def test_a_scaled_camera_object_looks_the_same(scene):
    scene.camera.rotation_euler = (0.3, 0.4, 0.5)
    plain = extract(scene).camera.matrix
    scene.camera.scale = (2.0, 0.5, 3.0)
    np.testing.assert_allclose(extract(scene).camera.matrix, plain, atol=1e-6)


def test_a_parents_shear_leaves_a_camera_that_looks_the_same_way(scene):
    parent = bpy.data.objects.new("Parent", None)
    scene.collection.objects.link(parent)
    parent.scale = (2.0, 2.0, 2.0)
    scene.camera.parent = parent
    camera = extract(scene).camera
    np.testing.assert_allclose(camera.matrix[:3, :3], np.eye(3), atol=1e-6)
    np.testing.assert_allclose(camera.position, (0, 0, 10), atol=1e-5)


def test_no_camera_is_one_line(scene):
    scene.camera = None
    with pytest.raises(SceneError, match='scene "Scene" has no camera; add one'):
        extract(scene)


def test_a_panoramic_camera_is_one_line(scene):
    scene.camera.data.type = "PANO"
    with pytest.raises(SceneError, match='camera "Camera" is panoramic'):
        extract(scene)


def test_resolution_and_bounces(scene):
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 801, 601, 50
    scene.cycles.glossy_bounces, scene.cycles.max_bounces = 7, 3
    found = extract(scene)
    assert found.resolution == (400, 300)
    assert found.glossy_bounces == 3
    scene.cycles.max_bounces = 12
    assert extract(scene).glossy_bounces == 7


def test_the_frame_asked_for_is_the_one_read(scene):
    scene.camera.location.x = 0.0
    scene.camera.keyframe_insert("location", frame=1)
    scene.camera.location.x = 9.0
    scene.camera.keyframe_insert("location", frame=10)
    scene.frame_set(4)
    found = extract(scene, frame=10)
    assert found.frame == 10
    assert found.camera.position[0] == pytest.approx(9.0)
    assert scene.frame_current == 4


def test_lamps(scene):
    stage.add_lamp(scene, "Sun", "SUN", 3.0, size=0.2)
    stage.add_lamp(scene, "Point", "POINT", 50.0, (1, 2, 3), size=0.25)
    spot = stage.add_lamp(scene, "Spot", "SPOT", 40.0)
    spot.data.spot_size, spot.data.spot_blend, spot.data.color = 1.0, 0.4, (1.0, 0.5, 0.25)
    area = stage.add_lamp(scene, "Area", "AREA", 10.0, rotation=(0.5, 0, 0), size=2.0)
    area.data.shape, area.data.size_y, area.scale = "RECTANGLE", 1.0, (2.0, 3.0, 4.0)
    hidden = stage.add_lamp(scene, "Hidden", "POINT", 1.0)
    hidden.hide_render = True
    lamps = {lamp.name: lamp for lamp in extract(scene).lamps}
    assert set(lamps) == {"Sun", "Point", "Spot", "Area"}
    assert lamps["Sun"].kind is LampKind.SUN
    assert lamps["Sun"].size == pytest.approx((0.1, 0.0))
    assert lamps["Sun"].color == pytest.approx((3.0, 3.0, 3.0))
    np.testing.assert_allclose(lamps["Point"].matrix[:3, 3], (1, 2, 3))
    assert lamps["Point"].size[0] == pytest.approx(0.25)
    assert lamps["Spot"].cone == pytest.approx((0.5, 0.4))
    assert lamps["Spot"].color == pytest.approx((40.0, 20.0, 10.0))
    assert lamps["Area"].size == pytest.approx((2.0, 1.5))
    np.testing.assert_allclose(np.linalg.norm(lamps["Area"].matrix[:3, :3], axis=0), 1.0)


def test_a_lamps_exposure_and_temperature(scene):
    lamp = stage.add_lamp(scene, "Lamp", "POINT", 8.0)
    lamp.data.exposure = 1.0
    assert extract(scene).lamps[0].color == pytest.approx((16.0, 16.0, 16.0))
    lamp.data.use_temperature, lamp.data.temperature = True, 2000.0
    red, green, blue = extract(scene).lamps[0].color
    assert red > 2.0 * green > 4.0 * blue


def test_a_lamps_own_nodes_multiply(scene):
    lamp = stage.add_lamp(scene, "Lamp", "POINT", 8.0)
    lamp.data.use_nodes = True
    emission = lamp.data.node_tree.nodes["Emission"]
    emission.inputs["Color"].default_value = (1.0, 0.5, 0.0, 1.0)
    emission.inputs["Strength"].default_value = 2.0
    assert extract(scene).lamps[0].color == pytest.approx((16.0, 8.0, 0.0))

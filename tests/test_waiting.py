"""Waiting for the GPU, and drawing in pieces."""

import moderngl
import numpy as np
import pytest
from catoptric.addon.gl import call, read_back, render, require

WIDTH = 64
_VERTEX = """#version 410 core
void main() {
    gl_PointSize = 1.0;
    gl_Position = vec4((gl_VertexID + 0.5) / 32.0 - 1.0, 0.0, 0.0, 1.0);
}"""
_FRAGMENT = """#version 410 core
out vec4 drawn;
void main() { drawn = vec4(0.25); }"""


@pytest.mark.parametrize(("first", "count", "most"), [(0, 64, 64), (0, 64, 7), (10, 20, 3), (5, 0, 3), (63, 1, 50)])
def test_pieces_draw_each_vertex_once(first, count, most):
    def drawn() -> np.ndarray:
        context = require()
        texture = context.texture((WIDTH, 1), 4, dtype="f4")
        target = context.framebuffer([texture])
        array = context.vertex_array(context.program(_VERTEX, _FRAGMENT), [])
        try:
            target.clear()
            target.use()
            context.enable_only(moderngl.BLEND)
            context.blend_func = moderngl.ONE, moderngl.ONE
            render(array, moderngl.POINTS, count, first, most)
            return np.frombuffer(read_back(texture), np.float32).reshape(WIDTH, 4)[:, 0]
        finally:
            for part in (array, target, texture):
                part.release()

    expected = np.zeros(WIDTH)
    expected[first : first + count] = 0.25
    np.testing.assert_array_equal(call(drawn), expected)


def test_what_is_read_back_is_a_part_where_asked():
    def read() -> bytes:
        buffer = require().buffer(bytes(range(8)))
        try:
            return read_back(buffer, size=4)
        finally:
            buffer.release()

    assert call(read) == bytes(range(4))

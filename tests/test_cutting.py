"""Triangles are cut where they are near to something, no more than asked, and nothing is lost."""

import numpy as np
from catoptric.addon.tracing import Near, cut_near
from hypothesis import given, settings
from hypothesis import strategies as st


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), share=st.floats(0.1, 2.0), count=st.integers(1, 6), near=st.integers(0, 3))
def test_pieces_tile_their_triangles_and_are_short_enough(seed, share, count, near):
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(count, 3, 3)) * 4
    low = rng.normal(size=(near, 3)) * 3
    boxes = np.stack([low, low + rng.uniform(0, 2, size=(near, 3))], axis=1)
    least = rng.uniform(0.2, 1.0, size=near)
    pieces, source = cut_near(corners, [Near(boxes[i:], least[i:]) for i in (0, near // 2) if near > i], share)
    areas = np.linalg.norm(np.cross(pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0]), axis=1)
    whole = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.allclose(np.bincount(source, areas, count), np.linalg.norm(whole, axis=1))
    # Each piece lies in the triangle that it is said to be of, and faces its way.
    ab, ac = (corners[source, None, k] - corners[source, None, 0] for k in (1, 2))
    flat = whole[source, None]
    square = (flat * flat).sum(axis=-1)
    off = pieces - corners[source, None, 0]
    u, v = ((np.cross(*pair) * flat).sum(axis=-1) / square for pair in ((off, ac), (ab, off)))
    assert min(u.min(), v.min(), (1 - u - v).min()) > -1e-9
    ways = np.cross(pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0])
    assert ((ways * whole[source]).sum(axis=1) >= 0).all()
    longest = np.linalg.norm(np.roll(pieces, -1, axis=1) - pieces, axis=2).max(axis=1)
    for box, enough in zip(boxes, least, strict=True):
        gap = np.maximum(np.maximum(box[0] - pieces.max(axis=1), pieces.min(axis=1) - box[1]), 0)
        assert (longest <= np.maximum(share * np.linalg.norm(gap, axis=1), enough) * (1 + 1e-12)).all()


@settings(deadline=None, max_examples=20)
@given(most=st.integers(3, 200), seed=st.integers(0, 1000))
def test_no_more_pieces_than_allowed(most, seed):
    corners = np.random.default_rng(seed).normal(size=(3, 3, 3)) * 10
    box = np.array([[[-1.0, -1, -1], [1, 1, 1]]])
    pieces, source = cut_near(corners, [Near(box, np.array([0.01]))], 0.05, most)
    assert len(pieces) == len(source) <= most
    assert set(source) == {0, 1, 2}


def test_nothing_is_cut_where_nothing_reflects():
    corners = np.random.default_rng(1).normal(size=(4, 3, 3)) * 100
    pieces, source = cut_near(corners, [], 0.1)
    assert np.array_equal(pieces, corners)
    assert source.tolist() == [0, 1, 2, 3]
    pieces, source = cut_near(corners[:0], [], 0.1)
    assert pieces.shape == (0, 3, 3)
    assert source.shape == (0,)


def test_what_is_short_enough_stays_whole():
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[4.0, 0, 0], [5, 0, 0], [4, 1, 0]]])
    boxes = np.array([[[-1.0, 0, 0], [-0.9, 1, 1]]])
    pieces, source = cut_near(corners, [Near(boxes, np.array([0.1]))], 0.5)
    # The far one begins 4.9 m away, and no edge of it is longer than 1.5 m; the near one has no 0.5 m to spare.
    assert (source == 1).sum() == 1
    np.testing.assert_array_equal(pieces[source == 1][0], corners[1])
    assert (source == 0).sum() > 1


def test_many_boxes_are_looked_at_in_several_goes():
    """More pairs than fit into one; only the last box is near."""
    corners = np.random.default_rng(0).uniform(-3.0, 3.0, (100, 3, 3))
    far = np.full((5000, 2, 3), 1e6)
    far[-1] = 0.0
    one, many = Near(far[-1:], np.full(1, 0.1)), Near(far, np.full(len(far), 0.1))
    for pieces, wanted in zip(cut_near(corners, [many], 0.5), cut_near(corners, [one], 0.5), strict=True):
        np.testing.assert_array_equal(pieces, wanted)

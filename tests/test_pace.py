"""How coarse pictures become while something moves."""

from catoptric.addon.methods.pace import Pace
from hypothesis import given
from hypothesis import strategies as st


def scales(pace: Pace, cost: float, pictures: int = 10) -> list[int]:
    """Of pictures one after the other, of which a whole one takes `cost` seconds."""
    used = []
    for _ in range(pictures):
        used.append(pace.scale)
        pace.took(pace.scale, cost / pace.scale**2)
    return used


def test_slow_pictures_become_coarser_until_they_are_fluent():
    assert scales(Pace(4), 0.2) == [1] + [2] * 9
    assert scales(Pace(4), 0.9) == [1, 2] + [4] * 8


def test_none_is_coarser_than_the_coarsest():
    assert max(scales(Pace(2), 100.0)) == 2


def test_fast_pictures_are_whole_again():
    pace = Pace(4)
    scales(pace, 10.0)
    assert scales(pace, 0.001)[-1] == 1


def test_a_whole_picture_at_rest_does_not_begin_it_anew():
    pace = Pace(4)
    scales(pace, 0.9)
    pace.took(1, 0.9)
    assert pace.scale == 4


@given(st.floats(0.0, 10.0), st.sampled_from([1, 2, 4, 8]))
def test_it_settles(cost, coarsest):
    """A picture of one scale is not too fast where the next finer one was too slow: it does not flicker."""
    pace = Pace(coarsest)
    assert len(set(scales(pace, cost, 20)[8:])) == 1

"""A declared parameter takes what it should, and says in one line what it does not."""

import math

import pytest
from catoptric.addon.errors import UsageError
from catoptric.addon.methods.registry import METHODS, named
from catoptric.addon.parameters import Parameter, resolve
from catoptric.batch.options import parse_frames, parse_names, parse_resolution, parse_settings
from hypothesis import given
from hypothesis import strategies as st

COUNT = Parameter("count", "Count", 4, "How many", minimum=1, maximum=16)
SHARE = Parameter("share", "Share", 0.5, "How much", minimum=0.0, maximum=1.0)
SWITCH = Parameter("switch", "Switch", False, "Whether")
KIND = Parameter("kind", "Kind", "box", "Which", choices=("box", "sphere"))
ALL = (COUNT, SHARE, SWITCH, KIND)


@given(st.integers())
def test_a_number_is_taken_within_its_bounds_alone(value):
    if 1 <= value <= 16:
        assert COUNT.parse(str(value)) == value
    else:
        with pytest.raises(UsageError, match="count"):
            COUNT.parse(str(value))


@given(st.floats(0.0, 1.0))
def test_a_float_survives_its_text(value):
    assert SHARE.parse(repr(value)) == value


@pytest.mark.parametrize("text", ["nan", "inf", "-inf", "-0.1", "1.1", "half", ""])
def test_what_is_no_share_is_refused(text):
    with pytest.raises(UsageError, match="share"):
        SHARE.parse(text)


@pytest.mark.parametrize(("text", "value"), [("on", True), ("False", False), ("1", True), ("no", False)])
def test_a_switch_reads_words(text, value):
    assert SWITCH.parse(text) is value


@pytest.mark.parametrize(("parameter", "text"), [(SWITCH, "maybe"), (KIND, "cone"), (COUNT, "4.5")])
def test_the_message_names_parameter_and_value(parameter, text):
    with pytest.raises(UsageError) as failure:
        parameter.parse(text)
    assert parameter.name in str(failure.value)
    assert text in str(failure.value)


def test_what_is_not_given_has_its_default():
    assert resolve(ALL, {"count": "8"}) == {"count": 8, "share": 0.5, "switch": False, "kind": "box"}


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(UsageError, match="count, share, switch, kind"):
        resolve(ALL, {"size": 1})


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_every_default_of_every_method_is_allowed(method):
    settings = resolve(method.parameters, {})
    for parameter in method.parameters:
        assert settings[parameter.name] == parameter.parse(str(parameter.default))
        assert parameter.help
        assert parameter.label


def test_registry_knows_each_method_by_its_own_name():
    assert all(named(name).name == name for name in METHODS)
    with pytest.raises(UsageError, match="environment-map"):
        named("mirror-magic")


@given(st.integers(0, 10**6), st.integers(0, 10**6), st.sampled_from("xX×"))
def test_a_resolution_is_two_numbers(width, height, cross):
    assert parse_resolution(f"{width}{cross}{height}") == (width, height)


@pytest.mark.parametrize("text", ["768", "x512", "-1x5", "768x512x3", "big", "7.5x2", ""])
def test_no_resolution(text):
    with pytest.raises(UsageError, match="768x512"):
        parse_resolution(text)


@given(st.integers(-1000, 1000), st.integers(0, 50))
def test_frames_are_a_closed_range(first, more):
    assert parse_frames(f"{first}:{first + more}") == tuple(range(first, first + more + 1))
    assert parse_frames(str(first)) == (first,)


@pytest.mark.parametrize("text", ["10:1", "a:b", "1:2:3", "", "1-10", ":5"])
def test_no_frames(text):
    with pytest.raises(UsageError, match="1:10"):
        parse_frames(text)


def test_names_come_once_each_and_must_exist():
    assert parse_names("b, a,b", ("a", "b", "c"), "--methods") == ("b", "a")
    for text in ("a,d", "", ","):
        with pytest.raises(UsageError, match="a, b, c"):
            parse_names(text, ("a", "b", "c"), "--methods")


def test_settings_are_those_of_the_methods_that_run():
    settings = parse_settings(["environment-map.size=64"], ("environment-map", "layered-depth"))
    assert settings["environment-map"]["size"] == 64
    assert settings["layered-depth"] == resolve(METHODS["layered-depth"].parameters, {})


@pytest.mark.parametrize(
    "text", ["size=64", "environment-map.size", "environment-map.sizes=64", "environment-map.size=0", "none.size=64"]
)
def test_wrong_settings_are_refused(text):
    with pytest.raises(UsageError):
        parse_settings([text], ("environment-map",))


def test_settings_of_a_method_that_does_not_run_are_refused():
    with pytest.raises(UsageError, match="not among the methods"):
        parse_settings(["environment-map.size=64"], ("layered-depth",))


def test_infinity_is_no_count():
    with pytest.raises(UsageError):
        COUNT.parse(math.inf)

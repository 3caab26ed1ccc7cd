"""The disk cache: keys follow content, entries come back bit-exactly or not at all."""

import errno
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import pytest
from catoptric.addon.cache import Cache, key_of
from catoptric.addon.errors import MachineError
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp


class Flavour(IntEnum):
    SOUR = 0
    SWEET = 1


@dataclass(frozen=True)
class Cake:
    name: str
    layers: tuple
    flavour: Flavour = Flavour.SWEET


@dataclass(frozen=True)
class Bread:
    name: str
    layers: tuple
    flavour: Flavour = Flavour.SWEET


LEAVES = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(allow_nan=False), st.text(max_size=4), st.binary(max_size=4)
)
NESTED = st.recursive(LEAVES, lambda inner: st.tuples(inner, inner) | st.dictionaries(st.text(max_size=3), inner))


def typed(part):
    """`part` with its types spelled out: 1, 1.0 and True are equal in Python but not the same content."""
    if isinstance(part, tuple):
        return tuple(typed(inner) for inner in part)
    if isinstance(part, dict):
        return {key: typed(inner) for key, inner in part.items()}
    return type(part).__name__, repr(part)


@given(NESTED, NESTED)
def test_keys_are_equal_exactly_when_the_contents_are(first, second):
    assert (key_of(first) == key_of(second)) == (typed(first) == typed(second))


def test_keys_tell_lookalikes_apart():
    zeros = np.zeros((2, 3), np.float32)
    lookalikes = [
        (), (None,), ("None",), (0,), (0.0,), (False,), ("ab", "c"), ("a", "bc"), ("abc",), (("ab", "c"),),
        (zeros,), (zeros.T,), (zeros.astype(np.int32),), (zeros.ravel(),), (Flavour.SOUR,), (Flavour.SWEET,),
        (Cake("a", ()),), (Bread("a", ()),), (Cake("a", (), Flavour.SOUR),), (Cake("a", (zeros,)),),
        ({"a": 1},), ({"a": 1, "b": 2},),
    ]  # fmt: skip
    assert len({key_of(*parts) for parts in lookalikes}) == len(lookalikes)


def test_keys_ignore_memory_layout_and_insertion_order():
    values = np.arange(12, dtype=np.float32).reshape(3, 4)
    assert key_of(values) == key_of(np.asfortranarray(values)) == key_of(np.repeat(values, 2, axis=1)[:, ::2])
    assert key_of({"a": 1, "b": 2}) == key_of({"b": 2, "a": 1})


def test_keys_are_the_same_in_another_process():
    code = "from catoptric.addon.cache import key_of; print(key_of('a', {'x': 1.5, 'y': (None, True)}))"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == key_of("a", {"x": 1.5, "y": (None, True)})


@pytest.mark.parametrize("part", [object(), {1, 2}, np.array([object()]), Cake], ids=repr)
def test_what_has_no_content_has_no_key(part):
    with pytest.raises(TypeError):
        key_of(part)


@given(hnp.arrays(st.sampled_from([np.float32, np.uint8, np.int64]), hnp.array_shapes(min_side=0)))
def test_entries_come_back_bit_exactly(tmp_path_factory, values):
    cache = Cache(tmp_path_factory.mktemp("cache"))
    cache.put("things", "key", {"values": values, "more": values.T}, {"seconds": 1.5, "name": "Åse"})
    entry = cache.get("things", "key")
    assert entry.meta == {"seconds": 1.5, "name": "Åse"}
    for name, wanted in (("values", values), ("more", values.T)):
        assert entry.arrays[name].dtype == wanted.dtype
        assert entry.arrays[name].shape == wanted.shape
        assert entry.arrays[name].tobytes() == wanted.tobytes()


def test_what_was_not_put_is_absent(tmp_path):
    cache = Cache(tmp_path / "not" / "yet")
    assert cache.get("things", "key") is None
    assert cache.size() == 0
    cache.put("things", "key", {})
    assert cache.get("others", "key") is None
    assert cache.get("things", "other") is None


@pytest.mark.parametrize("damage", ["flip", "truncate", "empty", "append"])
def test_a_damaged_entry_counts_as_absent_and_goes(tmp_path, damage):
    cache = Cache(tmp_path)
    cache.put("things", "key", {"values": np.arange(1000)})
    (path,) = tmp_path.rglob("*.npz")
    content = bytearray(path.read_bytes())
    if damage == "flip":
        content[len(content) // 2] ^= 1
    damaged = {"flip": content, "truncate": content[:-100], "empty": b"", "append": content + b"x"}[damage]
    path.write_bytes(damaged)
    assert cache.get("things", "key") is None
    assert not path.exists()
    cache.put("things", "key", {"values": np.arange(3)})
    assert cache.get("things", "key").arrays["values"].tolist() == [0, 1, 2]


def test_clear_and_size(tmp_path):
    cache = Cache(tmp_path)
    cache.put("a", "1", {"values": np.zeros(1000, np.float64)})
    assert 8000 < cache.size() < 9000
    cache.put("b", "1", {"values": np.zeros(1000, np.float64)})
    assert 16000 < cache.size() < 18000
    cache.clear()
    assert cache.size() == 0
    assert cache.get("a", "1") is None


def test_what_was_used_longest_ago_goes_first(tmp_path):
    cache = Cache(tmp_path, limit=20000)
    for age, key in ((300, "old"), (200, "middle")):
        cache.put("a", key, {"values": np.zeros(1000)})
        os.utime(tmp_path / "a" / f"{key}.npz", (os.stat(tmp_path).st_mtime - age,) * 2)
    cache.get("a", "old")
    cache.put("a", "new", {"values": np.zeros(1000)})
    assert cache.get("a", "middle") is None
    assert cache.get("a", "old") is not None
    assert cache.get("a", "new") is not None


def test_one_entry_beyond_the_limit_is_still_kept(tmp_path):
    cache = Cache(tmp_path, limit=10)
    cache.put("a", "big", {"values": np.zeros(1000)})
    assert cache.get("a", "big") is not None


@pytest.mark.skipif(os.name != "posix", reason="needs limits on file sizes")
def test_a_full_disk_is_one_line_and_loses_nothing(tmp_path):
    """A limit on file sizes stands in for the full disk: the write fails half-way, as it does there."""
    code = f"""
import errno, os, resource, signal
import numpy as np
from catoptric.addon import cache as module
cache = module.Cache({str(tmp_path)!r})
cache.put("a", "key", {{"values": np.arange(10)}})
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
try:
    cache.put("a", "key", {{"values": np.zeros(100_000)}})
except module.MachineError as error:
    print(error)
print(cache.get("a", "key").arrays["values"].sum(), os.listdir({str(tmp_path / "a")!r}))
"""
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    lines = told.stdout.splitlines()
    assert lines[0].startswith("cannot write to the cache folder")
    assert lines[1:] == ["45 ['key.npz']"]


def test_the_line_about_a_full_disk_says_what_to_do(tmp_path):
    message = Cache(tmp_path)._blame(OSError(errno.ENOSPC, "No space left on device"))
    assert "disk is full" in message
    assert "CATOPTRIC_CACHE" in message
    assert "\n" not in message


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(MachineError, match="set CATOPTRIC_CACHE"):
        Cache(tmp_path / "file" / "cache").put("a", "key", {})


def test_the_environment_moves_the_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("CATOPTRIC_CACHE", str(tmp_path))
    assert Cache().folder == tmp_path
    monkeypatch.delenv("CATOPTRIC_CACHE")
    assert Cache().folder != tmp_path


def test_what_is_kept_is_known_without_reading_it(tmp_path):
    cache, key = Cache(tmp_path), key_of("a")
    assert cache.look("kind", key) is None
    cache.put("kind", key, {"a": np.zeros(1000)})
    kept = cache.look("kind", key)
    assert kept.size == cache.size()
    assert abs(kept.written - time.time()) < 60
    os.utime(tmp_path / "kind" / f"{key}.npz", (0, 1000.0))
    assert cache.get("kind", key) is not None
    assert cache.look("kind", key).written == 1000.0  # to use it is not to write it
    cache.remove("kind", key)
    cache.remove("kind", key)
    assert cache.get("kind", key) is None

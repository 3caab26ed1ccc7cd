"""What was computed once, kept on disk under a key made of everything that determined it."""

import dataclasses
import errno
import hashlib
import json
import os
import struct
import tempfile
import time
from collections.abc import Iterable, Mapping
from enum import Enum
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
import platformdirs

from .errors import MachineError

DIRECTORY_VARIABLE = "CATOPTRIC_CACHE"
"""The environment variable that moves the cache to another folder."""

DEFAULT_LIMIT = 8 << 30
"""Bytes that the cache may fill before the entries that were used longest ago go."""

_DIGEST_SIZE = 32
_META = "__meta__"


class Entry(NamedTuple):
    """What `Cache.get` found: `arrays` by name, and `meta`, anything that JSON can hold."""

    arrays: dict[str, np.ndarray]
    meta: dict


class Kept(NamedTuple):
    """What is known of an entry without reading it: its `size` in bytes, and when it was `written`, as time.time()."""

    size: int
    written: float


def key_of(*parts: object) -> str:
    """A name for the content of `parts`: 40 hexadecimal digits that change whenever any of it does.

    Takes None, bool, int, float, str, bytes, paths, enums, NumPy scalars and arrays (by dtype,
    shape and values), dataclasses (by class and fields), tuples, lists and mappings of those,
    nested. Raises `TypeError` for anything else, whose content cannot be known.
    """
    digest = hashlib.blake2b(digest_size=20)
    _feed(digest, parts)
    return digest.hexdigest()


def _feed(digest: "hashlib._Hash", part: object) -> None:
    """Hash `part` with its type and its length in front, so that no two different contents read alike."""
    match part:
        case np.ndarray():
            if part.dtype.hasobject:
                raise TypeError("an array of objects has no content to make a key of")
            _tag(digest, "array", f"{part.dtype.str}{part.shape}".encode())
            digest.update(np.ascontiguousarray(part).data)
        case np.generic():
            _feed(digest, np.asarray(part))
        case Enum():
            _tag(digest, "enum", f"{type(part).__qualname__}.{part.name}".encode())
        case None | bool() | int():
            _tag(digest, type(part).__name__, repr(part).encode())
        case float():
            _tag(digest, "float", struct.pack("<d", part))
        case str() | Path():
            _tag(digest, "str", str(part).encode("utf-8", "surrogateescape"))
        case bytes():
            _tag(digest, "bytes", part)
        case Mapping():
            _feed_all(digest, "mapping", [entry for key in sorted(part, key=repr) for entry in (key, part[key])])
        case tuple() | list():
            _feed_all(digest, "sequence", part)
        case _ if dataclasses.is_dataclass(part) and not isinstance(part, type):
            values = [getattr(part, field.name) for field in dataclasses.fields(part)]
            _feed_all(digest, type(part).__qualname__, values)
        case _:
            raise TypeError(f"{type(part).__name__} has no content to make a key of")


def _tag(digest: "hashlib._Hash", kind: str, content: bytes) -> None:
    digest.update(f"{kind}:{len(content)}:".encode() + content)


def _feed_all(digest: "hashlib._Hash", kind: str, parts: Iterable[object]) -> None:
    listed = list(parts)
    _tag(digest, kind, str(len(listed)).encode())
    for part in listed:
        _feed(digest, part)


class Cache:
    """A folder of results, each in a file of its own, named by kind and key.

    An entry is a NumPy archive followed by the checksum of its bytes. It appears whole or not at
    all, two processes may share the folder, and a damaged file counts as absent.
    """

    def __init__(self, folder: Path | str | None = None, limit: int = DEFAULT_LIMIT) -> None:
        """`folder` defaults to $CATOPTRIC_CACHE, else the user's cache folder; `limit` is in bytes."""
        chosen = folder or os.environ.get(DIRECTORY_VARIABLE) or platformdirs.user_cache_path("catoptric", False)
        self.folder = Path(chosen)
        self.limit = limit

    def get(self, kind: str, key: str) -> Entry | None:
        """The entry that `put` wrote, or None if there is none. A damaged one is removed."""
        path = self._path(kind, key)
        try:
            with path.open("rb") as file:
                entry = _read(file)
            os.utime(path, (time.time(), path.stat().st_mtime))
        except (FileNotFoundError, NotADirectoryError):
            return None
        except PermissionError as error:
            raise MachineError(f"cannot read the cache file {path}: {error.strerror}") from error
        except (OSError, ValueError, KeyError):
            path.unlink(missing_ok=True)
            return None
        return entry

    def put(self, kind: str, key: str, arrays: Mapping[str, np.ndarray], meta: Mapping | None = None) -> None:
        """Keep `arrays` and `meta` under `key`. Raises `MachineError` if the disk is full or read-only."""
        path = self._path(kind, key)
        temporary = None
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile("w+b", dir=path.parent, suffix=".part", delete=False) as file:
                temporary = Path(file.name)
                _write(file, arrays, meta or {})
            os.replace(temporary, path)
        except OSError as error:
            raise MachineError(self._blame(error)) from error
        finally:
            if temporary is not None:
                temporary.unlink(missing_ok=True)
        self._make_room(path)

    def look(self, kind: str, key: str) -> Kept | None:
        """What is kept under `key`, without reading it; None if there is nothing."""
        try:
            status = self._path(kind, key).stat()
        except OSError:
            return None
        return Kept(status.st_size, status.st_mtime)

    def remove(self, kind: str, key: str) -> None:
        """Let one entry go, if it is there. Raises `MachineError` where the folder does not allow it."""
        try:
            self._path(kind, key).unlink(missing_ok=True)
        except OSError as error:
            raise MachineError(self._blame(error)) from error

    def size(self) -> int:
        """Bytes that all entries take on disk."""
        return sum(size for _, size, _ in self._files())

    def clear(self) -> None:
        """Remove every entry, and what interrupted writes have left."""
        for _, _, path in self._files():
            path.unlink(missing_ok=True)

    def _path(self, kind: str, key: str) -> Path:
        return self.folder / kind / f"{key}.npz"

    def _files(self) -> list[tuple[float, int, Path]]:
        """When each file was used last, its bytes, its path: oldest first."""
        files = []
        for pattern in ("*/*.npz", "*/*.part"):
            for path in self.folder.glob(pattern):
                try:
                    status = path.stat()
                except FileNotFoundError:  # another process has just cleared it
                    continue
                files.append((max(status.st_atime, status.st_mtime), status.st_size, path))
        return sorted(files)

    def _make_room(self, newest: Path) -> None:
        """Let the entries that were used longest ago go, until the rest fits."""
        files = self._files()
        excess = sum(size for _, size, _ in files) - self.limit
        for _, size, path in files:
            if excess <= 0:
                return
            if path != newest and path.suffix == ".npz":
                path.unlink(missing_ok=True)
                excess -= size

    def _blame(self, error: OSError) -> str:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            return f"the disk is full: free some space, or set {DIRECTORY_VARIABLE} (now {self.folder}) to another one"
        return (
            f"cannot write to the cache folder {self.folder}: {error.strerror};"
            f" set {DIRECTORY_VARIABLE} to one that can be written"
        )


def _write(file: BinaryIO, arrays: Mapping[str, np.ndarray], meta: Mapping) -> None:
    described = np.frombuffer(json.dumps(dict(meta)).encode(), np.uint8)
    np.savez(file, **{_META: described}, **arrays)
    file.write(_checksum(file, file.tell()))


def _read(file: BinaryIO) -> Entry:
    length = file.seek(0, os.SEEK_END) - _DIGEST_SIZE
    if length <= 0 or _checksum(file, length) != file.read(_DIGEST_SIZE):
        raise ValueError("damaged")
    file.seek(0)
    with np.load(file) as archive:
        arrays = {name: archive[name] for name in archive.files if name != _META}
        return Entry(arrays, json.loads(archive[_META].tobytes()))


def _checksum(file: BinaryIO, length: int) -> bytes:
    """The checksum of the first `length` bytes; leaves the file just behind them."""
    digest = hashlib.blake2b(digest_size=_DIGEST_SIZE)
    file.seek(0)
    while length > 0:
        block = file.read(min(length, 1 << 20))
        if not block:
            break
        digest.update(block)
        length -= len(block)
    return digest.digest()

"""What `eccentric.compile` keeps the next process runs: only what nobody else can have written is used."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from eccentric.compiled.entry import CacheEntry, keep_library, read_entry, read_record, write_entry
from eccentric.core import InputError

pytestmark = pytest.mark.skipif(os.name != "posix", reason="owners and modes are those of POSIX")


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the cache, as a process leaves it whose files anybody may write by default."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    before = os.umask(0)
    try:
        store()
    finally:
        os.umask(before)
    return tmp_path / "cache" / "eccentric"


def store() -> None:
    """Build a model, whose library is a text here."""

    def build(folder: Path) -> Path:
        (folder / "library.so").write_bytes(b"library")
        return folder / "library.so"

    write_entry("key", CacheEntry("arm", "module", (), (), (), keep_library("arm", build)))


def found() -> bool:
    """Whether the next process would run what is stored."""
    return read_entry("arm", "key") is not None


def test_the_cache_is_the_users_alone(cache: Path) -> None:
    """Whatever the umask is: nobody else may enter the folder, or read or write what is in it."""
    assert found()
    assert {0o700} == {path.stat().st_mode & 0o777 for path in (cache, *cache.iterdir())}


def test_a_folder_of_an_earlier_version_is_narrowed(cache: Path) -> None:
    """It had mode 755, or what the umask gave; the next model that is built closes it."""
    cache.chmod(0o755)
    assert found()
    store()
    assert 0o700 == cache.stat().st_mode & 0o777


@pytest.mark.parametrize("mode", [0o777, 0o720, 0o702])
@pytest.mark.parametrize("which", [".", "arm_*.so", "arm_key.json"], ids=["folder", "library", "record"])
def test_what_others_may_write_is_built_again(which: str, mode: int, cache: Path) -> None:
    """A folder, library or record of mode 777 is not used, although its digest is right; built anew it is."""
    (path,) = cache.glob(which) if which != "." else [cache]
    path.chmod(mode)

    assert not found()
    store()
    assert found()


@pytest.mark.parametrize("which", ["arm_*.so", "arm_key.json"], ids=["library", "record"])
def test_what_others_own_is_built_again(which: str, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A library or record of another user is not used, whatever its mode and digest."""
    (path,) = cache.glob(which)
    number, fstat = path.stat().st_ino, os.fstat

    def of_another(file: int) -> os.stat_result:
        held = fstat(file)
        return os.stat_result([*held[:4], held[4] + (held.st_ino == number), *held[5:]])

    with monkeypatch.context() as patch:
        patch.setattr("os.fstat", of_another)
        assert not found()
    store()
    assert found()


def test_a_cache_of_another_user_is_one_clear_line(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As after `sudo` that keeps HOME: nothing in it is used, and nothing is written to it."""
    before = sorted(path.stat().st_mtime_ns for path in (cache, *cache.iterdir()))
    user = os.geteuid()
    monkeypatch.setattr("os.geteuid", lambda: user + 1)

    assert read_record("arm_key") is None
    with pytest.raises(InputError, match=r"expected a cache of your own, .* set XDG_CACHE_HOME$"):
        store()
    assert before == sorted(path.stat().st_mtime_ns for path in (cache, *cache.iterdir()))

"""How this package compiles: the decorators of every compiled function, their cache on disk, and what is said about it.

Nothing else imports numba. Decorating compiles nothing; the first call does, or loads what an earlier process compiled.

* The cache lives in a folder of our own, named by a digest of all sources that hold compiled functions. By itself,
  numba notices a change in the file of the called function only, not in a file that it imports from.
* `NUMBA_CACHE_DIR` is respected as the parent folder; else it is the user's cache folder (XDG). There is no fallback to
  a shared temporary folder on purpose: cached code is executed, so nobody else may be able to write it.
* A folder that cannot be written, a full disk or a damaged file costs time, never an answer.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import re
import shutil
import sys
import tempfile
import threading
import time
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast

import numba
from numba.core import event as compiler_events

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

__all__ = ["KernelCacheWarning", "cache_folder", "jit", "leaf_jit", "parallel_jit", "prange"]

prange = numba.prange
"""`range` whose turns `parallel_jit` spreads over threads; plain `range` under `jit`."""

_Function = TypeVar("_Function", bound="Callable[..., Any]")

# Contraction to fused multiply-add is the one liberty the compiler has: it keeps NaN, signed zeros and the order of
# sums. The numpy error model divides by zero without an exception, which would keep loops from being vectorised.
_OPTIONS: Final[dict[str, Any]] = {"fastmath": {"contract"}, "error_model": "numpy", "nogil": True}

_numba_settings: Any = numba.config  # attributes made at run time, which the type checker cannot see

_PACKAGE: Final = Path(__file__).resolve().parent.parent

# Packages whose modules, in subfolders too, hold compiled functions, or helpers and constants that those use.
_SOURCE_FOLDERS: Final = ("kernels", "ik", "analytic")
_FOLDER_NAME: Final = re.compile(r"[0-9a-f]{20}")
_KEEP_DAYS: Final = 60.0


class KernelCacheWarning(RuntimeWarning):
    """Compiled kernels cannot be kept on disk, so every process compiles them anew."""


def jit(function: _Function) -> _Function:
    """Compiles a function for one thread, at its first call; to be called from Python or from other compiled code.

    It releases the interpreter lock while it runs.
    """
    return cast("_Function", _compiled(function, parallel=False))


def leaf_jit(function: _Function) -> _Function:
    """Compiles a function that makes no array of its own, without counting references to the arrays it is given.

    In a loop of small functions the counting, an atomic operation each time, takes as long as all the arithmetic. The
    caller holds the arrays anyway. Slices are fine, assigning to a slice is not (it may need a copy).
    """
    compiled = jit(function)
    target = getattr(compiled, "targetdescr", None)  # missing under NUMBA_DISABLE_JIT
    if hasattr(getattr(target, "options", None), "_nrt"):  # not a public option: without it, it is only slower
        cast("Any", compiled).targetoptions["_nrt"] = False
    return compiled


def parallel_jit(function: _Function) -> _Function:
    """Compiles a function whose `prange` loops run on all threads, at its first call; to be called from Python only.

    In a forked child process it runs on one thread, because GNU OpenMP, which numba uses where it finds it, ends a
    child that starts threads after a fork. Calls from several Python threads take turns, because numba's own thread
    pool, which it uses elsewhere, ends the process when they do not; each call has all cores anyway.
    """
    parallel, serial = _compiled(function, parallel=True), _compiled(function, parallel=False)

    @functools.wraps(function)
    def call(*arguments: Any) -> Any:
        if _process.forked:
            return serial(*arguments)
        with _process.turns:
            return parallel(*arguments)

    return cast("_Function", call)


@functools.cache
def cache_folder() -> Path | None:
    """The folder of this version's compiled functions, made if need be; None where it cannot be written.

    Warns:
        KernelCacheWarning: It cannot be written; said once.
    """
    parent = _cache_parent()
    folder = parent / source_digest(_sources())
    try:
        if not folder.is_dir():
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            _prune(parent)
        tempfile.TemporaryFile(dir=folder).close()
        os.utime(folder)  # so that pruning knows what is in use
    except OSError as error:
        message = (
            f"nao_kin cannot keep compiled kernels in {folder} ({error.strerror or error}), so every process compiles "
            "them anew. Set NUMBA_CACHE_DIR to a folder that can be written."
        )
        warnings.warn(message, KernelCacheWarning, stacklevel=2)
        return None
    return folder


def source_digest(files: Iterable[Path]) -> str:
    """Digest of the names and contents of source files and of numba's version, 20 hexadecimal digits."""
    digest = hashlib.sha256(numba.__version__.encode())
    for file in sorted(files):
        content = file.read_bytes()
        digest.update(f"\n{_place_of(file)} {len(content)}\n".encode())
        digest.update(content)
    return digest.hexdigest()[:20]


def _place_of(file: Path) -> str:
    """Where a file is below the package: a helper that moved to another folder is another source."""
    return file.relative_to(_PACKAGE).as_posix() if file.is_relative_to(_PACKAGE) else file.name


def _sources() -> list[Path]:
    return [file for folder in _SOURCE_FOLDERS for file in (_PACKAGE / folder).rglob("*.py")]


def _cache_parent() -> Path:
    if _numba_settings.CACHE_DIR:
        return Path(_numba_settings.CACHE_DIR) / "nao_kin"
    xdg = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if not xdg.is_absolute():  # which the XDG specification has ignored, like an empty one
        xdg = Path(os.path.expanduser("~")) / ".cache"  # noqa: PTH111 (Path.home may raise)
    return xdg / "nao_kin" / "kernels"


def _prune(parent: Path) -> None:
    """Removes folders of other versions of the sources that no process has used for a long time."""
    oldest = time.time() - _KEEP_DAYS * 86400.0
    for folder in parent.iterdir():
        with contextlib.suppress(OSError):  # another process may be doing the same
            if _FOLDER_NAME.fullmatch(folder.name) and not folder.is_symlink() and folder.stat().st_mtime < oldest:
                shutil.rmtree(folder)


def _compiled(function: Callable[..., Any], *, parallel: bool) -> Callable[..., Any]:
    dispatcher = numba.njit(parallel=parallel, **_OPTIONS)(function)
    folder = cache_folder()
    if folder is not None and hasattr(dispatcher, "enable_caching"):  # not under NUMBA_DISABLE_JIT
        # numba names a cache file by function and line, so the two variants of one function need folders of their own.
        with _caching_below(folder / ("parallel" if parallel else "serial")):
            try:
                dispatcher.enable_caching()
            except RuntimeError:  # "no locator available": the folder has become unwritable, or the source is in a zip
                return cast("Callable[..., Any]", dispatcher)
        _forgive_damage(dispatcher)
    return cast("Callable[..., Any]", dispatcher)


@contextlib.contextmanager
def _caching_below(folder: Path) -> Iterator[None]:
    """Has numba look for a function's cache below our folder and nowhere else, which it decides when asked to cache.

    The settings are put back, so functions of other packages are cached where they always were.
    """
    ours = {"CACHE_DIR": str(folder), "CACHE_LOCATOR_CLASSES": "UserProvidedCacheLocator"}
    with _process.turns:
        theirs = {key: getattr(_numba_settings, key, "") for key in ours}
        try:
            for key, value in ours.items():
                setattr(_numba_settings, key, value)
            yield
        finally:
            for key, value in theirs.items():
                setattr(_numba_settings, key, value)


def _forgive_damage(dispatcher: Any) -> None:
    """Makes a damaged cache file count as a missing one, and a full disk as no cache; numba lets both fail the call."""
    cache = getattr(dispatcher, "_cache", None)
    if cache is None or not all(hasattr(cache, name) for name in ("load_overload", "save_overload", "flush")):
        return
    load, save = cache.load_overload, cache.save_overload

    def load_or_none(*arguments: Any) -> Any:
        try:
            return load(*arguments)
        except Exception:  # a truncated pickle raises nearly anything
            with contextlib.suppress(OSError):
                cache.flush()
            return None

    def save_if_possible(*arguments: Any) -> None:
        with contextlib.suppress(OSError):
            save(*arguments)

    cache.load_overload, cache.save_overload = load_or_none, save_if_possible


class _Announcer(compiler_events.Listener):
    """Says on stderr, once a process, that one of our functions is being compiled: nothing else explains the wait.

    numba tells its listeners only when there was nothing to load from the cache.
    """

    def __init__(self) -> None:
        self.said = False

    def on_start(self, event: Any) -> None:
        """A compilation starts."""
        function = getattr((event.data or {}).get("dispatcher"), "py_func", None)
        if self.said or function is None or not function.__module__.startswith("nao_kin."):
            return
        self.said = True
        how_often = "once" if cache_folder() else "in every process, for want of a cache folder"
        if sys.stderr is not None:
            print(f"nao_kin: compiling kernels for this machine, {how_often}; some seconds …", file=sys.stderr)  # noqa: T201

    def on_end(self, event: Any) -> None:
        """A compilation ended."""


class _Process:
    """What threads share.

    Attributes:
        forked: Whether this process was forked from one that had this module imported.
        turns: Held by the thread whose turn it is to run a parallel kernel, or to change numba's settings.
    """

    def __init__(self) -> None:
        self.forked = False
        self.turns = threading.RLock()

    def after_fork(self) -> None:
        """In the child, where the thread that held the lock does not exist."""
        self.forked, self.turns = True, threading.RLock()


_process = _Process()
os.register_at_fork(after_in_child=_process.after_fork)
compiler_events.register("numba:compile", _Announcer())  # type: ignore[no-untyped-call]

"""Taking times in turns, so that a slow phase of the machine hits everything that is compared alike."""

from __future__ import annotations

import contextlib
import gc
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

__all__ = ["in_turns", "one_thread", "seconds", "timed", "undisturbed"]


@contextlib.contextmanager
def undisturbed() -> Iterator[None]:
    """Keeps the garbage collector from running inside somebody's time."""
    was_enabled = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


@contextlib.contextmanager
def one_thread() -> Iterator[None]:
    """Runs compiled code on one thread; also a decorator."""
    import numba

    threads = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        yield
    finally:
        numba.set_num_threads(threads)


def timed(call: Callable[[Any], Any], inputs: Iterable[Any]) -> tuple[list[float], list[Any]]:
    """The time of each call [s], and what it returned."""
    clock = time.perf_counter
    taken, answers = [], []
    for value in inputs:
        started = clock()
        answer = call(value)
        taken.append(clock() - started)
        answers.append(answer)
    return taken, answers


def seconds(job: Callable[[], object]) -> float:
    """The time of one call [s], with what it returns still alive at the end."""
    started = time.perf_counter()
    kept = job()
    taken = time.perf_counter() - started
    del kept
    return taken


def in_turns(
    jobs: Mapping[str, Callable[[], object]], rounds: Iterable[int], repeats: Mapping[str, int]
) -> dict[str, list[float]]:
    """Times [s] of the jobs, called one after the other in every round; a short job several times, as `repeats` says.

    A job of a millisecond that runs on all cores is ruined whenever another process takes one of them, so it needs
    more tries for a median than a loop of a tenth of a second does.
    """
    times: dict[str, list[float]] = {name: [] for name in jobs}
    for _ in rounds:
        for name, job in jobs.items():
            with undisturbed():
                times[name] += [seconds(job) for _ in range(repeats.get(name, 1))]
    return times

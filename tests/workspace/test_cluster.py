"""A Dask cluster makes the same map to the last bit, also when a worker dies on the way."""

from __future__ import annotations

import os
import signal
import threading
import time
from typing import TYPE_CHECKING, Any

import pytest

import nao_kin as nk
from tests.conftest import needs, robot

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.filterwarnings("default")  # a cluster that is closed leaves sockets and processes behind


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    distributed = needs("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        yield client


def test_two_workers_make_the_same_map(client: Any) -> None:
    for part, measure in (("left_arm", "manipulability"), ("left_leg", "smallest_singular_value")):
        chain = robot("nao").chain(part)
        here = nk.reachability(chain, 100_000, measure=measure, seed=2)  # type: ignore[arg-type]
        there = nk.reachability(chain, 100_000, measure=measure, seed=2, chunk=9999, client=client)  # type: ignore[arg-type]
        assert there.same_as(here)


def test_a_worker_may_be_killed(client: Any) -> None:
    chain = robot("nao").chain("left_arm")
    here = nk.reachability(chain, 4_000_000)
    before = set(client.run(os.getpid).values())
    victim, killed = min(before), []

    def kill() -> None:
        deadline = time.monotonic() + 60.0
        while not any(client.processing().values()) and time.monotonic() < deadline:
            time.sleep(0.005)
        os.kill(victim, signal.SIGKILL)
        killed.append(victim)

    killer = threading.Thread(target=kill)
    killer.start()
    there = nk.reachability(chain, 4_000_000, chunk=100_000, client=client)
    killer.join()
    assert killed == [victim]
    assert there.same_as(here)
    client.wait_for_workers(2, timeout=60)
    assert victim not in set(client.run(os.getpid).values())

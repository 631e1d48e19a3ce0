"""The chunks of a workspace map on a Dask cluster."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from nao_kin.errors import InvalidInputError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

__all__ = ["on_cluster"]

Task = TypeVar("Task")
Part = TypeVar("Part")


def on_cluster(
    client: Any, work: Callable[[Task, int, int], Part], task: Task, chunks: Iterable[tuple[int, int]]
) -> Iterator[Part]:
    """Yields what `work(task, first, count)` returns for every chunk, as it comes, and forgets it on the cluster.

    Dask computes a chunk again whose worker died, and gives up on one that took several workers with it; then its
    error is raised here.

    Raises:
        InvalidInputError: `client` is no `distributed.Client`.
        MissingExtraError: Dask is not installed.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise MissingExtraError("A cluster", "cluster") from None
    if not isinstance(client, Client):
        raise InvalidInputError("client", "a distributed.Client", type(client).__name__)
    futures = [client.submit(work, task, first, count, pure=False) for first, count in chunks]
    for future in as_completed(futures):
        yield future.result()
        future.release()

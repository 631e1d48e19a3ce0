"""Convergence plots for `nao-kin bench methods`: how the error of each method falls, median over the near targets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import nao_kin as nk
from nao_kin.bench.method_sets import LONG
from nao_kin.errors import MissingExtraError
from nao_kin.ik.methods import METHODS

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from nao_kin.arrays import Floats
    from nao_kin.bench.method_sets import TargetSet

__all__ = ["draw"]

_TARGETS = 50  # a median of more looks the same
_ITERATIONS = 5000


def draw(sets: Sequence[TargetSet], folder: Path) -> list[Path]:
    """One PNG a set: position error [m] over iterations, both logarithmic, a line a method.

    Raises:
        MissingExtraError: Matplotlib is not installed.
    """
    try:
        import matplotlib as mpl
    except ImportError:
        raise MissingExtraError("Convergence plots", "notebook") from None
    mpl.use("Agg")
    import matplotlib.pyplot as plt

    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for of in sets:
        figure, axes = plt.subplots(figsize=(9.0, 5.5), layout="constrained")
        _lines(axes, of)
        written.append(folder / f"convergence_{of.chain.name.replace(' ', '_')}.png")
        figure.savefig(written[-1], dpi=110)
        plt.close(figure)
    return written


def _lines(axes: Any, of: TargetSet) -> None:
    target = nk.Target.of(of.native[0])
    able = [method for method in METHODS.values() if method.refusal(of.chain, target) is None]
    for number, method in enumerate(able):
        error = _median_error(of, method.name)
        dashes = ("-", "--", ":")[number // 7]
        axes.plot(np.arange(1, len(error) + 1), error, dashes, color=f"C{number % 7}", label=method.name, linewidth=1.6)
    axes.axhline(1e-6, color="0.6", linewidth=0.8)
    axes.text(1.0, 1.2e-6, "reached", color="0.4", fontsize=8)
    axes.set(xscale="log", yscale="log", xlabel="iteration + 1", ylabel="position error, median [m]")
    axes.set_title(f"{of.name}: {of.kind} targets within 0.2 rad, one start")
    axes.set_ylim(bottom=1e-10)
    axes.legend(ncols=1, fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0))


def _median_error(of: TargetSet, method: str) -> Floats:
    """Median position error [m] of the iterates, each run's last one kept until the longest has ended."""
    traces = []
    for target, q0 in zip(of.native[:_TARGETS], of.starts[:_TARGETS], strict=True):
        result = nk.solve(of.chain, target, q0, method=method, budget=LONG, trace=True)
        if result.trace is not None:
            traces.append(result.trace.position_error)
    longest = min(_ITERATIONS, max(map(len, traces)))
    padded = [np.concatenate([t[:longest], np.full(max(0, longest - len(t)), t[-1])]) for t in traces]
    return np.asarray(np.median(np.maximum(padded, 1e-17), axis=0))

"""`nao-kin workspace`: a map of where a tip can be."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.cli.chain_arguments import SPEC_HELP, chain_from_spec
from nao_kin.output import FormatOption, OutputFormat, report, report_json

if TYPE_CHECKING:
    from nao_kin.chain import Chain
    from nao_kin.view.scene import Scene
    from nao_kin.workspace.reach_map import ReachMap

__all__ = ["workspace"]


def workspace(
    chain: Annotated[str, typer.Argument(help=SPEC_HELP)],
    samples: Annotated[int, typer.Option(help="Configurations.")] = 1_000_000,
    voxel: Annotated[float | None, typer.Option(help="Edge of a cube [m]; default a round number.")] = None,
    measure: Annotated[str, typer.Option(help="manipulability, smallest_singular_value or none.")] = "manipulability",
    axes: Annotated[str, typer.Option(help="Directions that count in the measure.")] = "xyz",
    sampling: Annotated[str, typer.Option(help="random or even.")] = "random",
    seed: Annotated[int, typer.Option(help="Where the sequence of configurations starts.")] = 0,
    save: Annotated[Path | None, typer.Option(help="An npz file to write.")] = None,
    picture: Annotated[Path | None, typer.Option(help="A picture to write: png, svg or pdf.")] = None,
    html: Annotated[Path | None, typer.Option(help="A page to write.")] = None,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Map where a chain's tip can be, from configurations inside its limits, and how well it moves there."""
    from nao_kin.workspace.mapping import reachability

    which = chain_from_spec(chain)
    choices: dict[str, Any] = {"measure": measure, "axes": axes, "sampling": sampling, "seed": seed}
    reach = reachability(which, samples, voxel=voxel, **choices)
    if format is OutputFormat.json:
        report_json(_data(reach))
    else:
        report(reach.table())
    if save is not None:
        typer.echo(f"wrote {reach.save(save)}", err=True)
    if picture is not None:
        reach.plot().savefig(picture)
        typer.echo(f"wrote {picture}", err=True)
    if html is not None:
        from nao_kin.replacing import replace_file
        from nao_kin.view.page import page

        replace_file(html, page(_scene(which, reach)).encode("utf-8"))
        typer.echo(f"wrote {html}", err=True)


def _data(reach: ReachMap) -> dict[str, Any]:
    plain = ("chain", "base_name", "tip_name", "samples", "sampling", "seed", "voxel", "volume", "measure", "axes")
    data: dict[str, Any] = {name: getattr(reach, name) for name in plain}
    data |= {"cubes": int(reach.reached.sum()), "extent": reach.extent}
    if reach.measure != "none":
        mean = float((reach.mean * reach.counts).sum() / reach.samples)
        data |= {"unit": reach.unit, "mean": mean, "greatest": float(reach.greatest.max())}
    return data


def _scene(chain: Chain, reach: ReachMap) -> Scene:
    """The map around its robot, or around the stick figure of a table."""
    import numpy as np

    from nao_kin.robot.urdf_chain import UrdfChain
    from nao_kin.view.contents import scene_of
    from nao_kin.view.overlay import chain_scene
    from nao_kin.view.workspace_scene import with_workspace

    if not isinstance(chain, UrdfChain):
        return with_workspace(chain_scene(chain), reach, np.eye(4))
    return scene_of(chain.robot, reach)

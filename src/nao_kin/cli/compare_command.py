"""`nao-kin compare`: a table against a model, or any two chains."""

from __future__ import annotations

from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.cli.chain_arguments import SPEC_HELP, chain_from_spec
from nao_kin.output import FormatOption, OutputFormat, report, report_json

if TYPE_CHECKING:
    from nao_kin.chain import Chain
    from nao_kin.crosscheck import Comparison

__all__ = ["compare", "comparison_data", "explanation_data", "overlay_data"]


class ReadAs(StrEnum):
    """Conventions to read a table in."""

    standard = "standard"
    modified = "modified"


def compare(
    table: Annotated[str, typer.Argument(help=SPEC_HELP)],
    chain: Annotated[str | None, typer.Argument(help="The same; default for a document chain: its robot.")] = None,
    read_as: Annotated[ReadAs | None, typer.Option(help="Read the table in this convention, not its own.")] = None,
    explain: Annotated[
        bool, typer.Option("--explain", help="Search the usual errors that would account for it.")
    ] = False,
    corrected: Annotated[Path | None, typer.Option(help="Write a table that agrees to this TOML file.")] = None,
    html: Annotated[str | None, typer.Option(help="Write a page that shows both, where they differ most.")] = None,
    samples: Annotated[int, typer.Option(min=1, help="Random configurations.")] = 1000,
    seed: Annotated[int, typer.Option(help="Seed of the random configurations.")] = 0,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Hold two chains against each other exactly as given; exit status 1 if they disagree.

    With --explain, every equally simple set of usual errors in the first chain that would account for a disagreement.
    """
    from nao_kin.crosscheck import compare as hold_against

    a = chain_from_spec(table)
    if read_as is not None:
        from nao_kin.dh.dh_chain import DHChain

        if not isinstance(a, DHChain):
            raise typer.BadParameter("--read-as is for tables; a robot's model has no convention.")
        a = a.read_as(read_as.value)
    b = chain_from_spec(chain) if chain is not None else _model_of(table)
    _same_number_of_rows(table, a, b)
    found = hold_against(a, b, samples=samples, seed=seed)
    if format is OutputFormat.json:
        report_json(comparison_data(found) | (explanation_data(found) if explain else {}))
    else:
        report(found.table(), *(["", str(found.explanation)] if explain else []))
    if html is not None:
        from nao_kin.view.export import export_html

        typer.echo(f"wrote {export_html(html, found, explain=explain)}", err=True)
    if corrected is not None:
        _write_corrected(found, corrected)
    if not found.agrees:
        raise typer.Exit(1)


def comparison_data(found: Comparison) -> dict[str, Any]:
    """A comparison as plain data."""
    departure = found.first_departure
    return {
        "a": found.a.name,
        "b": found.b.name,
        "agrees": found.agrees,
        "max_position_error": found.max_position_error,
        "max_rotation_error": found.max_rotation_error,
        "max_linear_jacobian_error": found.max_linear_jacobian_error,
        "max_angular_jacobian_error": found.max_angular_jacobian_error,
        "worst_position_q": found.worst_position_q,
        "worst_rotation_q": found.worst_rotation_q,
        "first_departure": None if departure is None else asdict(departure),
        "samples": found.samples,
        "gauge": None if found.gauge is None else str(found.gauge),
        "first_pair": None if found.first_pair is None else asdict(found.first_pair),
        "overlay": overlay_data(found),
    }


def overlay_data(found: Comparison) -> dict[str, Any]:
    """Both chains where their tips are farthest apart: T_base_link of each joint's link and T_base_tip, row by row."""
    q = found.worst_position_q

    def frames(chain: Chain) -> list[Any]:
        return [*chain.link_poses(q), chain.pose(q).homogeneous]

    return {"q": q, "joints": found.b.path_joint_names, "a": frames(found.a), "b": frames(found.b)}


def explanation_data(found: Comparison) -> dict[str, Any]:
    """The explanation of a comparison as plain data; `corrected` is TOML text."""
    explanation = found.explanation
    smallest = explanation.smallest
    return {
        "explanation": {
            "text": str(explanation),
            "exact": explanation.exact,
            "position_tolerance": explanation.position_tolerance,
            "rotation_tolerance": explanation.rotation_tolerance,
            "steps": [asdict(step) for step in explanation.steps],
            "alternatives": [
                {
                    "edits": one.edits,
                    "kinds": one.kinds,
                    "position_error": one.position_error,
                    "rotation_error": one.rotation_error,
                    "table": one.table.to_toml(),
                }
                for one in explanation.alternatives
            ],
            "smallest_changes": None
            if smallest is None
            else {
                "changes": smallest.changes,
                "position_error": smallest.position_error,
                "rotation_error": smallest.rotation_error,
            },
        },
        "corrected": None if found.corrected is None else found.corrected.to_toml(),
    }


def _same_number_of_rows(spec: str, a: Chain, b: Chain) -> None:
    """A table file with too few or too many rows is refused at its last row; other chains are `compare`'s to refuse."""
    if not spec.endswith(".toml") or len(a.joints) == len(b.joints):
        return
    from nao_kin.errors import TableFileError

    lines = Path(spec).read_text(encoding="utf-8-sig").splitlines()
    last = max((k for k, line in enumerate(lines, start=1) if line.split("#")[0].strip() == "[[joint]]"), default=None)
    names = ", ".join(b.joint_names)
    raise TableFileError(spec, last, f"row {len(a.joints)} is the last one; expected {len(b.joints)} rows ({names}).")


def _write_corrected(found: Comparison, path: Path) -> None:
    if found.corrected is None:
        typer.echo(f"nao-kin: no table that agrees was found, so {path} is not written.", err=True)
        return
    from nao_kin.replacing import replace_file

    replace_file(path, found.corrected.to_toml().encode("utf-8"))


def _model_of(table: str) -> Chain:
    from nao_kin.documents.chains import DOCUMENT_CHAINS
    from nao_kin.robot.robot import load

    if table not in DOCUMENT_CHAINS:
        raise typer.BadParameter(f"say what to hold {table} against: ROBOT:CHAIN or ROBOT:BASE:TIP.")
    document = DOCUMENT_CHAINS[table]
    return load(document.robot).chain(document.base, document.tip)

"""The report of an alignment: one self-contained page, and the rows that it shares with the CLI."""

from __future__ import annotations

import html
from importlib.resources import files
from string import Template
from typing import Any

import numpy as np

import limitsurf
from limitsurf.actuators.activation import direction_error
from limitsurf.planning.array_verification import ArrayVerification
from limitsurf.planning.turn_function import TurnFunction
from limitsurf.plot.errors import draw_errors
from limitsurf.plot.part import draw_part
from limitsurf.plot.runs import animate_runs
from limitsurf.plot.squeeze import draw_plan, draw_squeeze_function
from limitsurf.plot.turn import draw_turn_function

__all__ = ["alignment_page", "plan_rows", "summary_rows", "verdict"]

Rows = list[tuple[str, ...]]


def summary_rows(turn: TurnFunction, verification: ArrayVerification) -> Rows:
    """Return what was simulated and what came out, as (name, value) rows."""
    array, part = verification.activations[0].array, verification.part
    low, high = verification.interval
    times = verification.durations.sum(axis=1)
    error = max(direction_error(activation) for activation in verification.activations)
    return [
        ("part", f"{part.name}: {part!r}"),
        ("array", f"{array.name}: {array!r}"),
        ("stable orientations", _degrees(turn.stable)),
        ("unstable orientations", _degrees(turn.unstable)),
        ("least margin of the plan", _margin(verification.plan.least_margin)),
        (
            "direction error of the push",
            f"{np.degrees(error):.2f} deg; no equilibrium is left beyond the critical angle "
            f"{np.degrees(turn.critical_angle):.2f} deg",
        ),
        ("push of a tip", f"{array.pixel.offset_fraction:.3f} of friction times load"),
        ("motion", f"{verification.mode}, {verification.samples} starts, seed {verification.seed}"),
        (
            "success rate",
            f"{100 * verification.rate:.1f} % "
            f"(95 % interval {100 * low:.1f} to {100 * high:.1f} %)",
        ),
        (
            "final orientation error",
            f"median {_median_error(verification):.2f} deg, "
            f"tolerance {np.degrees(verification.tolerance):.3g} deg",
        ),
        ("time to align", f"median {np.median(times):.2f} s, longest {times.max():.2f} s"),
        (
            "certified error of the friction",
            f"at most {verification.worst_errors.max():.1e} of the part's weight",
        ),
    ]


def plan_rows(verification: ArrayVerification) -> Rows:
    """Return the plan as rows (step, line angle, margin, share of runs at rest)."""
    plan = verification.plan
    at_rest = (verification.outcomes == 1).mean(axis=0)
    return [
        (str(k + 1), f"{np.degrees(line):.2f} deg", _margin(margin), f"{100 * share:.0f} %")
        for k, (line, margin, share) in enumerate(
            zip(plan.lines, plan.margins, at_rest, strict=True)
        )
    ]


def verdict(verification: ArrayVerification) -> str:
    """Return the outcome in one sentence."""
    plan = verification.plan
    aligned = int(verification.successes.sum())
    return (
        f"{aligned} of {verification.samples} runs came to rest within "
        f"{np.degrees(verification.tolerance):.3g} deg of {np.degrees(plan.final):.1f} deg "
        f"modulo {np.degrees(plan.period):.4g} deg after {len(plan.lines)} "
        f"squeeze{'s' if len(plan.lines) > 1 else ''}."
    )


def alignment_page(turn: TurnFunction, verification: ArrayVerification) -> str:
    """Return the report as one HTML page that needs no other file."""
    from plotly.offline import get_plotlyjs

    part, array = verification.part, verification.activations[0].array
    page = Template(files("limitsurf.report").joinpath("page.html").read_text(encoding="utf-8"))
    return page.substitute(
        title=html.escape(f"Alignment of {part.name} on {array.name}"),
        plotly_js=get_plotlyjs(),
        verdict=html.escape(verdict(verification)),
        summary=_table(summary_rows(turn, verification)),
        animation=_figure(animate_runs(verification), "runs"),
        plan_table=_table(plan_rows(verification), ("step", "line", "margin", "runs at rest")),
        plan_figure=_figure(draw_plan(verification.plan), "plan"),
        part_figure=_figure(draw_part(part, turn), "part"),
        turn_figure=_figure(draw_turn_function(turn), "turn"),
        squeeze_figure=_figure(draw_squeeze_function(verification.plan.squeeze), "squeeze"),
        errors_figure=_figure(draw_errors(verification), "errors"),
        version=limitsurf.__version__,
    )


def _figure(figure: Any, name: str) -> str:
    return str(
        figure.to_html(
            full_html=False,
            include_plotlyjs=False,
            div_id=name,
            auto_play=False,
            config={"responsive": True, "displaylogo": False},
        )
    )


def _table(rows: Rows, head: tuple[str, ...] = ()) -> str:
    lines = ["<div><table>"]
    if head:
        lines.append("<tr>" + "".join(f"<th>{html.escape(cell)}</th>" for cell in head) + "</tr>")
    lines += [
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    ]
    return "\n".join([*lines, "</table></div>"])


def _degrees(angles: Any) -> str:
    return ", ".join(f"{angle:.2f}" for angle in np.degrees(angles)) + " deg"


def _margin(margin: float) -> str:
    return f"{np.degrees(margin):.2f} deg" if np.isfinite(margin) else "any angle"


def _median_error(verification: ArrayVerification) -> float:
    return float(np.degrees(np.median(np.abs(verification.errors))))

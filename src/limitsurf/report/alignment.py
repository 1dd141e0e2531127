"""The report of an alignment: one self-contained page, and the rows that it shares with the CLI."""

from __future__ import annotations

import html
from dataclasses import dataclass
from importlib.resources import files
from string import Template
from typing import Any

import numpy as np
from numpy.typing import NDArray

import limitsurf
from limitsurf.actuators.activation import direction_error
from limitsurf.planning.array_verification import ArrayVerification
from limitsurf.planning.robustness import Robustness
from limitsurf.planning.turn_function import TurnFunction
from limitsurf.plot.errors import draw_errors
from limitsurf.plot.part import draw_part
from limitsurf.plot.robustness import draw_robustness
from limitsurf.plot.runs import animate_runs
from limitsurf.plot.squeeze import draw_plan, draw_squeeze_function
from limitsurf.plot.turn import draw_turn_function

__all__ = ["PLAN_HEAD", "Findings", "alignment_page", "plan_rows", "summary_rows", "verdict"]

Array = NDArray[np.float64]
Rows = list[tuple[str, ...]]

PLAN_HEAD = ("step", "line", "margin", "on this array", "expected time", "runs at rest")


@dataclass(frozen=True, eq=False)
class Findings:
    """What is known about a plan on an array.

    Attributes
    ----------
    turn : TurnFunction
        That of the part.
    robustness : Robustness
        What the errors of the array leave of the plan.
    verification : ArrayVerification
        Simulated runs.
    durations : (k,) float
        Expected time of each line in the continuum field [s]; nan if parts take too long.
    """

    turn: TurnFunction
    robustness: Robustness
    verification: ArrayVerification
    durations: Array


def summary_rows(findings: Findings) -> Rows:
    """Return what was simulated and what came out, as (name, value) rows."""
    verification, robustness = findings.verification, findings.robustness
    array, part = verification.activations[0].array, verification.part
    times = verification.durations.sum(axis=1)
    return [
        ("part", f"{part.name}: {part!r}"),
        ("array", f"{array.name}: {array!r}"),
        ("stable orientations", _degrees(findings.turn.stable)),
        ("unstable orientations", _degrees(findings.turn.unstable)),
        ("model of a step", verification.plan.model),
        ("least margin of the plan", _margin(verification.plan.least_margin)),
        *_direction_rows(findings),
        ("push of a tip", f"{array.pixel.offset_fraction:.3f} of friction times load"),
        (
            "plan on this array",
            f"{robustness.status}; final orientation within "
            f"{np.degrees(robustness.final_width):.2f} deg with errors at their worst",
        ),
        ("motion", f"{verification.mode}, {verification.samples} starts, seed {verification.seed}"),
        ("success rate", _rate(verification)),
        (
            "final orientation error",
            f"median {_median_error(verification):.2f} deg, "
            f"tolerance {np.degrees(verification.tolerance):.3g} deg",
        ),
        ("expected time to align", _expected_time(findings)),
        ("time to a full stop", f"median {np.median(times):.2f} s, longest {times.max():.2f} s"),
        (
            "certified error of the friction",
            f"at most {verification.worst_errors.max():.1e} of the part's weight",
        ),
    ]


def plan_rows(findings: Findings) -> Rows:
    """Return the plan as rows with what `PLAN_HEAD` says.

    These are step, line angle, margin, status on the array, expected time, share of runs at rest.
    """
    plan = findings.verification.plan
    at_rest = (findings.verification.outcomes == 1).mean(axis=0)
    steps = zip(
        plan.lines,
        plan.margins,
        findings.robustness.steps,
        findings.durations,
        at_rest,
        strict=True,
    )
    return [
        (
            str(k),
            f"{np.degrees(line):.2f} deg",
            _margin(margin),
            status,
            _seconds(time),
            f"{100 * share:.0f} %",
        )
        for k, (line, margin, status, time, share) in enumerate(steps, 1)
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


def alignment_page(findings: Findings) -> str:
    """Return the report as one HTML page that needs no other file."""
    from plotly.offline import get_plotlyjs

    verification, turn = findings.verification, findings.turn
    part, array = verification.part, verification.activations[0].array
    page = Template(files("limitsurf.report").joinpath("page.html").read_text(encoding="utf-8"))
    return page.substitute(
        title=html.escape(f"Alignment of {part.name} on {array.name}"),
        plotly_js=get_plotlyjs(),
        verdict=html.escape(verdict(verification)),
        summary=_table(summary_rows(findings)),
        animation=_figure(animate_runs(verification), "runs"),
        plan_table=_table(plan_rows(findings), PLAN_HEAD),
        plan_figure=_figure(draw_plan(verification.plan), "plan"),
        robustness_figure=_figure(draw_robustness(findings.robustness), "robustness"),
        part_figure=_figure(draw_part(part, turn), "part"),
        turn_figure=_figure(draw_turn_function(turn), "turn"),
        squeeze_figure=_figure(draw_squeeze_function(verification.plan.squeeze), "squeeze"),
        errors_figure=_figure(draw_errors(verification), "errors"),
        version=limitsurf.__version__,
    )


def _direction_rows(findings: Findings) -> Rows:
    """Return the row of the direction error; none if lines pass by the array's centre."""
    activations, turn = findings.verification.activations, findings.turn
    if findings.verification.beside:
        return []
    error = max(direction_error(activation) for activation in activations)
    return [
        (
            "direction error of the push",
            f"{np.degrees(error):.2f} deg; no equilibrium is left beyond the critical angle "
            f"{np.degrees(turn.critical_angle):.2f} deg",
        )
    ]


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


def _expected_time(findings: Findings) -> str:
    moved_first = findings.verification.plan.model in ("centred", "push-squeeze")
    note = ", not counting how it is centred before each line" if moved_first else ""
    return _seconds(float(findings.durations.sum())) + note


def _seconds(time: float) -> str:
    return f"{time:.2f} s" if np.isfinite(time) else "not known"


def _rate(verification: ArrayVerification) -> str:
    low, high = (100 * share for share in verification.interval)
    return f"{100 * verification.rate:.1f} % (95 % interval {low:.1f} to {high:.1f} %)"


def _median_error(verification: ArrayVerification) -> float:
    return float(np.degrees(np.median(np.abs(verification.errors))))

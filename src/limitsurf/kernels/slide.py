"""A part on an activated array in implicit steps, fixed or adaptive."""

from __future__ import annotations

import math

import numpy as np

from limitsurf.kernels.compile import Floats, compiled
from limitsurf.kernels.contact_problem import new_best
from limitsurf.kernels.contact_totals import new_table
from limitsurf.kernels.row_spans import Spans, no_spans
from limitsurf.kernels.slide_step import (
    ENERGIES,
    HEAVIEST,
    LOAD_NOW,
    NEXT_FRAME,
    POSE,
    REST,
    SLACK,
    STEP,
    STEPS,
    TIME,
    TIME_LIMIT,
    TWIST_NOW,
    WIDTH,
    WORST,
    Body,
    Ground,
    Pace,
    Work,
    find_tips,
    is_over,
    take_step,
)
from limitsurf.kernels.tip_list import COUNT, new_tips

__all__ = ["FRAME", "slide"]

FRAME = 17  # time, pose, twist, load, bound, tips, kinetic, work, friction, drag, numerical
_SHORTEST = 1e-6  # steps are not made shorter than that, relative to the longest


@compiled
def _take_adaptively(
    body: Body,
    ground: Ground,
    pace: Pace,
    motion: Floats,
    most: float,
    spans: Spans,
    work: Work,
) -> tuple[bool, int, Spans]:
    """Take two half steps that differ little from a whole one, of at most `most`.

    Steps to where the part is off the array or not lifted get shorter until they move it no more
    than the local error. Return whether the part rests instead, the status, and the spans.
    """
    before = motion.copy()
    while True:
        dt = min(motion[STEP], most)
        if take_step(body, ground, pace, motion, dt, work):
            return True, TIME_LIMIT, spans
        target = motion[POSE : POSE + 3].copy()
        heaviest, worst, width = motion[HEAVIEST], motion[WORST], motion[WIDTH]
        motion[:] = before
        motion[HEAVIEST], motion[WORST], motion[WIDTH] = heaviest, worst, width
        if take_step(body, ground, pace, motion, 0.5 * dt, work):
            return True, TIME_LIMIT, spans
        status, spans = find_tips(body, ground, motion, spans, work)
        if status == TIME_LIMIT:
            take_step(body, ground, pace, motion, 0.5 * dt, work)
        if status != TIME_LIMIT or not is_over(body, ground, motion, work):
            target = before[POSE : POSE + 3]
        error = math.hypot(motion[POSE] - target[0], motion[POSE + 1] - target[1])
        error += body.reach * abs(motion[POSE + 2] - target[2])
        better = 0.9 * math.sqrt(pace.error * body.reach / max(error, 1e-300))
        next_step = min(max(dt * min(max(better, 0.2), 2.0), _SHORTEST * pace.dt), pace.dt)
        if better >= 0.9 or dt <= _SHORTEST * pace.dt:
            motion[STEP] = next_step
            return False, status, spans
        motion[:] = before
        motion[STEP] = next_step
        status, spans = find_tips(body, ground, motion, spans, work)


@compiled
def slide(
    body: Body,
    ground: Ground,
    pace: Pace,
    motion: Floats,
    until: float,
    steps: int,
    every: float,
    final: bool,
    frames: Floats,
) -> tuple[int, int, bool]:
    """Move a part until it rests, leaves, sinks, the time is up, or the steps are.

    Parameters
    ----------
    body, ground, pace : Body, Ground, Pace
        What moves on what, in which steps.
    motion : (24,) float
        From `new_motion`; goes on where it is, and ends where the motion does.
    until, steps : float, int
        Time limit [s], and steps after which to return for now.
    every : float
        Time between frames [s].
    final : bool
        Whether to write a frame when the time is up.
    frames : (K, FRAME) float
        Output rows ``time, pose, twist, load, error bound, tips, kinetic, work, friction, drag,
        numerical``; twist and load are those of the step that follows, the energies those so far.
        Without rows none is written.

    Returns
    -------
    status, rows : int
        One of TIME_LIMIT, REST, LEFT_ARRAY, NOT_LIFTED; rows written.
    over : bool
        False if only the steps were used up.
    """
    tips = new_tips(ground.lattice, body.reach)
    room = new_table(tips.rows.shape[0]) if ground.grip > 0.0 else new_table(0)
    work = Work(np.empty_like(body.edges), tips, new_best(), room, np.empty((0, 2)))
    if motion[STEP] == 0.0:
        motion[STEP] = pace.dt
    spans, taken, written, early = no_spans(), 0, 0, 1e-9 * pace.dt
    before = motion.copy()
    while True:
        status, spans = find_tips(body, ground, motion, spans, work)
        left = until - motion[TIME]
        over = status != TIME_LIMIT or left <= early
        before[:], rests = motion, False
        if not over:
            if pace.error > 0.0:
                rests, status, spans = _take_adaptively(
                    body, ground, pace, motion, left, spans, work
                )
            else:
                rests = take_step(body, ground, pace, motion, min(pace.dt, left), work)
            taken += 1
            status = REST if rests else status
        stop = over or rests or taken >= steps
        due = not over and before[TIME] >= motion[NEXT_FRAME] - early
        due = due or rests or (over and (final or status != TIME_LIMIT))
        if due and written < frames.shape[0]:
            _write(body, before, motion, tips.numbers[COUNT], frames[written])
            written += 1
            motion[NEXT_FRAME] = every * (math.floor((before[TIME] + early) / every) + 1.0)
        if stop:
            motion[STEPS] += taken
            return status, written, over or rests


@compiled
def _write(body: Body, at: Floats, after: Floats, count: int, frame: Floats) -> None:
    """Write a frame: time and pose of `at`, twist and load of the step that led to `after`."""
    frame[0:4] = at[TIME : POSE + 3]
    frame[4:7] = after[TWIST_NOW : TWIST_NOW + 3]
    frame[7:10] = after[LOAD_NOW : LOAD_NOW + 3]
    frame[10], frame[11] = after[SLACK], count
    v = at[TWIST_NOW : TWIST_NOW + 3]
    frame[12] = 0.5 * np.sum(body.mass * v * v)
    frame[13:17] = at[ENERGIES : ENERGIES + 4]

"""Pictures of limitsurf objects; the objects themselves have no plot method.

Every function returns a plotly figure, with units on its axes: ``draw_part(part).show()``; only
`animate` returns a matplotlib animation.
"""

from limitsurf.plot.alignment import draw_alignment
from limitsurf.plot.animation import animate
from limitsurf.plot.diameter import draw_diameter_function
from limitsurf.plot.equilibria import draw_equilibria
from limitsurf.plot.errors import draw_errors
from limitsurf.plot.limit_curve import draw_limit_curve
from limitsurf.plot.limit_surface import draw_limit_surface
from limitsurf.plot.part import draw_part
from limitsurf.plot.phase import draw_phase_portrait
from limitsurf.plot.robustness import draw_robustness
from limitsurf.plot.runs import animate_runs
from limitsurf.plot.squeeze import draw_plan, draw_squeeze_function
from limitsurf.plot.turn import draw_turn_function

__all__ = [
    "animate",
    "animate_runs",
    "draw_alignment",
    "draw_diameter_function",
    "draw_equilibria",
    "draw_errors",
    "draw_limit_curve",
    "draw_limit_surface",
    "draw_part",
    "draw_phase_portrait",
    "draw_plan",
    "draw_robustness",
    "draw_squeeze_function",
    "draw_turn_function",
]

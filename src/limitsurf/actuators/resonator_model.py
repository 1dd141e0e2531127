"""Schema of a resonator's model file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from limitsurf.modelfiles import Model, Sourced, find_model, load_model, number

__all__ = ["ResonatorModel", "read_resonator"]


class ResonatorModel(Model):
    """Schema of a resonator model file; the fields are those of `TorsionalResonator`."""

    description: str
    poles: Literal["+x", "-x", "both", "none"]
    driven: Literal["+x", "-x", "both"]
    drive: Literal["sine", "biased"]
    grid_width: Annotated[Sourced, number("m", above=0.0)]
    grid_length: Annotated[Sourced, number("m", above=0.0)]
    beam_width: Annotated[Sourced, number("m", above=0.0)]
    beam_height: Annotated[Sourced, number("m", above=0.0)]
    beam_pitch: Annotated[Sourced, number("m", above=0.0)]
    rod_length: Annotated[Sourced, number("m", above=0.0)]
    rod_offset: Annotated[Sourced, number("m")]
    clearance: Annotated[Sourced, number("m", above=0.0)]
    effective_width: Annotated[Sourced, number("m", above=0.0)]
    cell_area: Annotated[Sourced, number("m^2", above=0.0)]
    pole_height: Annotated[Sourced, number("m", at_least=0.0)]
    pole_section: Annotated[Sourced, number("m^2", at_least=0.0)]
    density: Annotated[Sourced, number("kg/m^3", above=0.0)]
    shear_modulus_tall: Annotated[Sourced, number("Pa", above=0.0)]
    shear_modulus_flat: Annotated[Sourced, number("Pa", above=0.0)]
    quality: Annotated[Sourced, number("", above=0.0)]
    contact_stiffness: Annotated[Sourced, number("N/m", above=0.0)]
    contact_damping: Annotated[Sourced, number("N*s/m", at_least=0.0)]
    restitution: Annotated[Sourced, number("", at_least=0.0)]


def read_resonator(name_or_path: str | Path) -> dict[str, Any]:
    """Return the fields of a `TorsionalResonator` from a model file.

    Raises
    ------
    ModelError
        Names the file, the field and what to do.
    """
    path = find_model("resonators", name_or_path)
    model = load_model(path, ResonatorModel)
    entries = {name: getattr(model, name) for name in ResonatorModel.model_fields}
    entries.pop("description")
    sourced = {name: x for name, x in entries.items() if isinstance(x, Sourced)}
    return {
        **{name: x.value if isinstance(x, Sourced) else x for name, x in entries.items()},
        "assumed": tuple(name for name, x in sourced.items() if x.assumed),
        "name": path.stem,
    }

"""Entry point of the ``limitsurf`` command."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Annotated

import typer

from limitsurf import __version__
from limitsurf.cli.align import align
from limitsurf.cli.models import models
from limitsurf.cli.warm_up import warm_up
from limitsurf.errors import LimitSurfError

__all__ = ["app", "main"]

app = typer.Typer(
    name="limitsurf",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command()(align)
app.command()(warm_up)
app.add_typer(models, name="models")


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"limitsurf {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Contact mechanics and sensorless alignment on actuator arrays."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; bad input is one line on standard error and exit code 2."""
    try:
        result = app(args=arguments, prog_name="limitsurf", standalone_mode=False)
    except typer.TyperException as error:
        return _fail(getattr(error, "format_message", error.__str__)())
    except LimitSurfError as error:
        return _fail(str(error))
    except (KeyboardInterrupt, typer.Abort):
        return _fail("interrupted")
    return result if isinstance(result, int) else 0


def _fail(message: str) -> int:
    print("limitsurf: " + " ".join(message.split()), file=sys.stderr)
    return 2

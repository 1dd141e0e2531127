"""Measured data that a user's clone does not have."""

import os

import pytest
from zhou2016 import folder


def measured_pushes():
    """Return the folder of the measured pushes; skip without them, but fail in CI."""
    found = folder()
    if (found / "logs").is_dir():
        return found
    missing = (
        f"the measured pushes are missing: no logs in {found}; set LIMITSURF_DATA to the folder "
        "that holds zhou2016 (see benchmarks/zhou2016.py)"
    )
    if os.environ.get("CI", "").lower() in ("", "0", "false"):
        pytest.skip(missing)
    pytest.fail(missing)

"""Importing limitsurf is quick and loads nothing heavy; every public name is there."""

import subprocess
import sys

import pytest

import limitsurf as ls

HEAVY = ("cvxpy", "sklearn", "matplotlib", "plotly", "numba", "xarray")


def test_import_is_light_and_quick():
    code = (
        "import sys, time; t = time.perf_counter(); import limitsurf; "
        "print(time.perf_counter() - t, *sys.modules)"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    seconds, *modules = result.stdout.split()
    assert not {name.split(".")[0] for name in modules} & set(HEAVY)
    assert float(seconds) < 1.0


def test_planning_and_motion_load_no_plots_and_no_solver():
    code = (
        "import sys, limitsurf as ls; ls.Part, ls.verify_alignment, ls.plan_alignment; "
        "print(*sys.modules)"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    loaded = {name.split(".")[0] for name in result.stdout.split()}
    assert not loaded & {"cvxpy", "sklearn", "matplotlib", "plotly"}


@pytest.mark.parametrize("name", ls.__all__)
def test_public_name_exists(name):
    assert getattr(ls, name) is not None
    assert name in dir(ls)


def test_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = ls.no_such_name


@pytest.mark.parametrize("name", [*ls.fitting.__all__, *ls.datasets.__all__])
def test_names_of_fitting_and_data_are_no_modules(name):
    home = ls.fitting if name in ls.fitting.__all__ else ls.datasets
    assert getattr(home, name).__class__.__name__ != "module"


def test_fitting_without_scikit_learn_names_what_to_install():
    code = (
        "import sys; sys.modules['sklearn'] = None\nimport limitsurf as ls; ls.datasets\n"
        "try: ls.fitting\nexcept ImportError as error: print(error)"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert "needs sklearn: pip install 'limitsurf[fit]'" in result.stdout

"""Every example in docstrings and README runs and gives what it says."""

import doctest
import importlib
import pkgutil
import re
from pathlib import Path

import numpy as np
import pytest

import limitsurf

ROOT = Path(__file__).parents[1]
MODULES = [
    module.name
    for module in pkgutil.walk_packages(limitsurf.__path__, "limitsurf.")
    if not module.ispkg
]


@pytest.mark.parametrize("name", MODULES)
def test_docstring_examples(name):
    results = doctest.testmod(importlib.import_module(name))
    assert results.failed == 0


def test_there_are_docstring_examples():
    finder = doctest.DocTestFinder()
    found = [
        test
        for name in MODULES
        for test in finder.find(importlib.import_module(name))
        if test.examples
    ]
    assert len(found) >= 8


def python_blocks(path):
    return re.findall(r"```python\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL)


def test_readme_example_runs(capsys):
    code = python_blocks(ROOT / "README.md")[0]
    assert len([line for line in code.splitlines() if line.strip()]) <= 10
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    printed = capsys.readouterr().out
    assert repr(names["plan"]) in printed
    assert repr(names["result"]) in printed
    assert names["result"].rate > 0.9


def test_readme_example_of_plans_runs(capsys):
    code = python_blocks(ROOT / "README.md")[1]
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    printed = capsys.readouterr().out
    assert repr(names["plan"]) in printed
    assert names["plan"].final == pytest.approx(0.0)
    assert names["sided"].period == pytest.approx(2 * np.pi)
    assert "100 of 100 runs aligned" in printed


DOCS = [
    pytest.param(code, id=f"{page.stem} {k}")
    for page in sorted((ROOT / "docs").glob("*.md"))
    for k, code in enumerate(python_blocks(page))
]


@pytest.mark.parametrize("code", DOCS)
def test_example_in_docs_runs(code, capsys):
    """Every block of Python runs by itself and prints something."""
    exec(compile(code, "docs", "exec"), {})
    assert "print(" not in code or capsys.readouterr().out


def test_readme_example_of_motion_runs(capsys):
    code = python_blocks(ROOT / "README.md")[3]
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    assert "a contact sticks" in capsys.readouterr().out
    stop, mean, tips = names["stop"], names["mean"], names["tips"]
    assert [e.kind.name for e in stop.events] == ["STICK", "REST"]
    assert stop.events[0].time < stop.events[1].time
    assert mean.outcome is tips.outcome is type(tips.outcome).REST
    assert abs(mean.final_pose[2] - tips.final_pose[2]) < 0.1


def test_readme_example_of_friction_runs(capsys):
    code = python_blocks(ROOT / "README.md")[2]
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    answer = names["answer"]
    assert repr(answer) in capsys.readouterr().out
    assert answer.net - answer.friction == pytest.approx([2.5, 0.0, 0.1])
    assert not answer.sticks
    assert answer.projection.error_bound < 1e-10


def test_readme_example_of_fitting_runs(capsys):
    code = python_blocks(ROOT / "README.md")[4]
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    found, model = names["found"], names["model"]
    assert found.advice in capsys.readouterr().out
    assert found.table.angle[found.recommended] == found.table.angle.min()
    exact = limitsurf.datasets.make_sliding_data(names["feet"].limit_surface(), 200, 0.0, rho=0.05)
    assert -model.score(exact.loads, exact.twists) < np.radians(4.0)
    assert model.surface_.support([1.0, 0.0, 0.0]) == pytest.approx(1.0, rel=0.02)


def test_links_within_the_repository_work():
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")]
    broken = [
        f"{page.name}: {target}"
        for page in pages
        for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8"))
        if not (page.parent / target).exists()
    ]
    assert not broken

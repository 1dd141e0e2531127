"""Every notebook runs, and is stored without outputs."""

from pathlib import Path

import nbformat
import pytest

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))
PRINTED = {
    "01_active_contacts": ("Wheel(", "all numbers hold"),
    "02_walker": ("SteadyWalk(held)", "all numbers hold"),
    "03_slider_on_array": ("Runs(200: 200 at rest)", "all numbers hold"),
    "04_alignment": ("TurnCertificate(complete", "cannot be aligned", "all numbers hold"),
    "05_fit_measured_pushes": (" pushes", "recommended: ", "all numbers hold"),
    "06_identify_an_actuator": ("errors of offset", "all numbers hold"),
    "align_a_part": ("AlignmentPlan(", "Verification("),
}


def test_there_are_notebooks():
    assert NOTEBOOKS


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebook_is_stored_without_outputs(path):
    notebook = nbformat.read(path, as_version=4)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in cells)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::RuntimeWarning:zmq")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebook_runs(path):
    from nbclient import NotebookClient

    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=200, resources={"metadata": {"path": path.parent}}).execute()
    printed = "".join(
        output.get("text", "")
        for cell in notebook.cells
        if cell.cell_type == "code"
        for output in cell.outputs
    )
    assert all(text in printed for text in PRINTED[path.stem])

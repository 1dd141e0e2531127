"""Warming up: every kernel that the package compiles lazily is compiled afterwards."""

import os
import subprocess
import sys

import pytest

from limitsurf.cli.main import main
from limitsurf.cli.warm_up import GROUPS


def test_it_names_what_it_compiled(capsys):
    assert main(["warm-up", "--processes", "1"]) == 0
    shown = capsys.readouterr().out
    assert all(name in shown for name in GROUPS)


@pytest.mark.slow
@pytest.mark.timeout(900)  # one process, so that none overwrites the other's index of the cache
def test_afterwards_nothing_is_compiled(tmp_path):
    """In a new process the same calls find everything in the cache: no new files."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = "from limitsurf.cli.main import main; main(['warm-up', '--processes', '1'])"
    subprocess.run([sys.executable, "-c", command], env=environment, check=True)
    compiled = set(tmp_path.rglob("*.nbc"))
    assert len(compiled) > 50
    calls = "from limitsurf.cli.warm_up import GROUPS\nfor call in GROUPS.values(): call()"
    subprocess.run([sys.executable, "-c", calls], env=environment, check=True)
    assert set(tmp_path.rglob("*.nbc")) == compiled

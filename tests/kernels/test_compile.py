import pytest

from limitsurf.kernels.compile import drop_stale_caches


@pytest.fixture
def kernels(tmp_path):
    """Three kernels: c imports b, b imports a; each is compiled."""
    (tmp_path / "a.py").write_text("x = 1")
    (tmp_path / "b.py").write_text("from limitsurf.kernels.a import x")
    (tmp_path / "c.py").write_text("from limitsurf.kernels.b import x")
    drop_stale_caches(tmp_path)
    for name in "abc":
        compiled(tmp_path, name).write_text("machine code")
    return tmp_path


def compiled(folder, name):
    return folder / "__pycache__" / f"{name}.f-1.py311.1.nbc"


def test_nothing_is_dropped_without_a_change(kernels):
    (kernels / "a.py").touch()
    assert not drop_stale_caches(kernels)
    assert all(compiled(kernels, name).exists() for name in "abc")


def test_a_changed_source_drops_those_that_import_it(kernels):
    (kernels / "b.py").write_text("from limitsurf.kernels.a import x as y")
    assert drop_stale_caches(kernels) == {"b", "c"}
    assert [compiled(kernels, name).exists() for name in "abc"] == [True, False, False]
    assert not drop_stale_caches(kernels)


def test_a_deleted_source_takes_its_compiled_code_along(kernels):
    (kernels / "c.py").unlink()
    drop_stale_caches(kernels)
    assert [compiled(kernels, name).exists() for name in "abc"] == [True, True, False]


def test_a_spoiled_stamp_drops_everything(kernels):
    (kernels / "__pycache__" / "kernels.json").write_text("{")
    assert drop_stale_caches(kernels) == {"a", "b", "c"}
    assert not any(compiled(kernels, name).exists() for name in "abc")


def test_a_read_only_folder_is_left_alone(tmp_path):
    (tmp_path / "a.py").write_text("x = 1")
    (tmp_path / "__pycache__").write_text("not a folder")
    assert drop_stale_caches(tmp_path)

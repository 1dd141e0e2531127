from limitsurf.kernels.compile import drop_stale_caches


def test_a_changed_source_drops_all_compiled_kernels(tmp_path):
    source, other = tmp_path / "a.py", tmp_path / "b.py"
    source.write_text("x = 1")
    other.write_text("y = 1")
    assert drop_stale_caches(tmp_path)
    compiled = tmp_path / "__pycache__" / "b.f-1.py311.1.nbc"
    compiled.write_text("machine code")
    assert not drop_stale_caches(tmp_path)
    assert compiled.exists()
    source.write_text("x = 22")
    assert drop_stale_caches(tmp_path)
    assert not compiled.exists()
    assert not drop_stale_caches(tmp_path)


def test_a_read_only_folder_is_left_alone(tmp_path):
    (tmp_path / "a.py").write_text("x = 1")
    (tmp_path / "__pycache__").write_text("not a folder")
    assert drop_stale_caches(tmp_path)

"""What `make demo` does, with the fixed model."""

import importlib.util

import pytest


@pytest.fixture(scope="module")
def demo(root):
    spec = importlib.util.spec_from_file_location("crfnet_demo", root / "tests" / "demo.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_prints_the_true_error_and_the_files(crfnet, demo, plate, fixed_model, tmp_path, capsys):
    crfnet("estimate", plate, "--out", tmp_path, "--model", fixed_model, "--no-sheet")
    demo.main(tmp_path)
    out = capsys.readouterr().out
    assert "gamma 2.2                           3.72" in out
    assert "this estimate                       0.01" in out
    assert "0.38" in next(line for line in out.splitlines() if "gamma 2.2" in line and "3.72" in line)
    assert "plate_linear.exr" in out

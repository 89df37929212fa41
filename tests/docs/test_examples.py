import json
import shutil

import numpy as np

from crfnet.luts.files import read_lut


def test_the_notebook_runs_where_it_lies_and_holds_no_outputs(root, plate, tmp_path, monkeypatch, capsys, tolerance):
    """In a copy of its folder, so that its files stay there."""
    (tmp_path / "docs" / "examples").mkdir(parents=True)
    (tmp_path / "tests" / "data").mkdir(parents=True)
    shutil.copy(plate, tmp_path / "tests" / "data")
    monkeypatch.chdir(tmp_path / "docs" / "examples")
    names: dict[str, object] = {}
    notebook = json.loads((root / "docs" / "examples" / "pipeline.ipynb").read_text(encoding="utf-8"))
    for cell in [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]:
        assert not cell["outputs"]
        exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
    assert names["linear"].shape == (378, 672, 3)
    assert names["linear"].dtype == np.float32
    assert names["lut_difference"] < tolerance.lut
    assert names["ocio_difference"] < tolerance.lut
    assert names["again"] == names["estimate"]
    assert read_lut(tmp_path / "docs" / "examples" / "look" / "plate.spi1d") == names["lut"]
    assert capsys.readouterr().out.splitlines()[0] == "(378, 672, 3) uint8 float32"

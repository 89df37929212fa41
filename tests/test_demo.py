import json

from tests import demo


def test_prints_the_true_error_and_the_files(crfnet, plate, fixed_model, tmp_path, capsys):
    crfnet("estimate", plate, "--out", tmp_path, "--model", fixed_model, "--no-sheet")
    demo.main(tmp_path)
    out = capsys.readouterr().out
    rows = {line[:24].strip(): line[24:].split() for line in out.splitlines() if line.startswith("  ")}
    assert rows["gamma 2.2"][::2] == ["3.34", "0.67"]
    assert all(float(own) < float(gamma) for own, gamma in zip(rows["this estimate"], rows["gamma 2.2"], strict=True))
    report = json.loads((tmp_path / "plate.json").read_text(encoding="utf-8"))
    expected = (report["uncertainty"], report["shape_uncertainty_stops"])
    assert rows["expected beforehand"] == [f"{error:.2f}" for error in expected]
    assert "plate_linear.exr" in out

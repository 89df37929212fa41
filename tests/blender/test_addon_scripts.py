"""The add-on for scripts: the README's example and its tables, and the response that can be read."""

import re
import runpy
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from .helpers import Panel, apply, bpy, curve_of, estimate, load

TYPES = {"STRING": "str", "BOOLEAN": "bool", "FLOAT": "float"}


@pytest.fixture(scope="module")
def readme(root):
    return (root / "blender_addon" / "README.md").read_text(encoding="utf-8")


def table(readme, head):
    """The cells behind the name, by the name, of the table whose first column has this head."""
    lines = readme.split(f"\n| {head} | type |")[1].split("\n\n")[0].splitlines()[2:]
    cells = [line.strip("| ").split(" | ") for line in lines]
    return {name: rest for names, *rest in cells for name in re.findall(r"`(\w+)`", names)}


def stated(argument):
    """Type and default of an argument, as the README states them."""
    match argument.type:
        case "ENUM":
            return [", ".join(f"`{item.identifier}`" for item in argument.enum_items), f"`{argument.default}`"]
        case "FLOAT":
            return [f"float, {argument.hard_min:.3g} to {argument.hard_max:.3g}", f"`{argument.default:.3g}`"]
    return [TYPES[argument.type], f'`"{argument.default}"`' if argument.type == "STRING" else f"`{argument.default}`"]


def test_the_readme_states_type_and_default_of_every_argument(addon, readme):
    estimating, applying = (
        {each.identifier: stated(each) for each in operator.get_rna_type().properties if each.is_runtime}
        for operator in (bpy.ops.crf.estimate_response, bpy.ops.crf.apply_response)
    )
    assert {name: cells[:2] for name, cells in table(readme, "argument").items()} == estimating
    assert estimating == applying | {"apply": estimating["apply"]}


def test_the_readme_states_the_type_of_every_property(addon, readme):
    found = bpy.types.Image.bl_rna.properties["camera_response"].fixed_type.properties
    types = {each.identifier: TYPES[each.type] for each in found if each.is_runtime}
    types |= {"warnings": "tuple of str", "curve": "NumPy array"}
    assert {name: cells[0] for name, cells in table(readme, "property").items()} == types


def test_the_readmes_script_bakes_and_saves_a_response(addon, readme, plate, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PWD", str(tmp_path))  # from which Blender takes the working directory
    shutil.copy(plate, "plate.jpg")
    (tmp_path / "script.py").write_text(readme.split("```python\n")[1].split("```")[0])
    monkeypatch.setattr(sys, "argv", ["blender", "--", "plate.jpg"])
    runpy.run_path("script.py")
    assert re.search(r"^plate.jpg: (good|usable), expected error 0\.\d\d stop", capsys.readouterr().out, re.MULTILINE)
    assert (tmp_path / "plate_linear.exr").is_file()
    assert (tmp_path / "plate.blend").is_file()
    assert bpy.data.images["plate.jpg"].camera_response.is_applied


@pytest.mark.parametrize("kind", ["image", "clip"])
def test_a_response_can_be_read_but_not_changed(addon, plate_file, kind):
    plate = load(plate_file, kind)
    response = plate.camera_response
    assert (response.is_stored, response.verdict, response.warnings, len(response.curve)) == (False, "", (), 0)
    estimate(plate)
    entries = plate["camera_response"]
    assert (response.verdict, response.origin, response.camera) == (entries["verdict"], "", "")
    assert response.expected_error == pytest.approx(entries["shape_uncertainty"])
    assert not response.is_applied
    np.testing.assert_array_equal(response.curve, curve_of(plate).brightness)
    entries["notices"] = '[["clipped", {}], ["gray", {}]]'
    assert response.warnings == ("clipped", "gray")
    with pytest.raises(AttributeError, match="read-only"):
        response.verdict = "usable"


def test_what_was_applied_can_be_read(estimated):
    apply(estimated, "NODES", exposure=1.5)
    assert (estimated.camera_response.is_applied, estimated.camera_response.exposure) == (True, 1.5)
    estimated.camera_response_settings.anchor = "GRAY"
    assert (estimated.camera_response.is_applied, estimated.camera_response.exposure) == (False, 1.5)


def test_the_preferences_have_a_button_for_the_documentation(addon):
    panel = Panel()
    type(addon).draw(panel, bpy.context)
    assert ("operator", "wm.path_open", "Documentation", "HELP") in panel.layout.drawn
    (path,) = (entry[2] for entry in panel.layout.drawn if entry[:2] == ("set", "filepath"))
    assert "# The Blender add-on" in Path(path).read_text(encoding="utf-8")

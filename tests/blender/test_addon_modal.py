"""The modal path, with its timer driven by hand: progress, Esc, errors."""

import time
from types import SimpleNamespace

import pytest

from tests.helpers.images import write_image

from .helpers import Interface, bpy, load_sequence, stored_estimate
from .helpers import estimate as run_now

TIMER = SimpleNamespace(type="TIMER", value="NOTHING")
ESC = SimpleNamespace(type="ESC", value="PRESS")
MOUSE = SimpleNamespace(type="MOUSEMOVE", value="NOTHING")


@pytest.fixture
def operator(addon):
    """An operator of the class that Blender registered, without Blender's part: properties and reports."""
    from blender_addon.ui.operators import PlateOperator

    class Driven(PlateOperator):
        def __init__(self, image, **choices):
            self.image, self.clip, self.anyway, self.reports = image, "", False, []
            vars(self).update(choices)
            self.properties = SimpleNamespace(is_property_set=lambda name: name in choices)

        def report(self, kind, text):
            self.reports.append((*kind, text))

    return Driven


def drive(operator, interface):
    """Send timer events until the operator ends; return how it ended."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        ended = operator.modal(interface, TIMER)
        if ended != {"PASS_THROUGH"}:
            return ended
        time.sleep(0.01)
    raise AssertionError("the operator did not end")


def test_runs_to_its_end(operator, interface, image, plate_file, estimate):
    run = operator(image.name, apply="NODES")
    assert run.invoke(interface, None) == {"RUNNING_MODAL"}
    assert interface.handlers == [run]
    assert "camera_response" not in image  # nothing happens in Blender before it has succeeded
    assert run.modal(interface, MOUSE) == {"PASS_THROUGH"}
    assert drive(run, interface) == {"FINISHED"}
    assert stored_estimate.restored(image).uncertainty == estimate(plate_file).uncertainty
    assert run.reports[0][0] == "INFO"
    assert interface.timers == []
    assert interface.status[-1] is None
    assert "Esc" in interface.status[0]
    assert interface.progress[-1] is None
    assert interface.redrawn[-2:] == ["UI", "WINDOW"]  # what was found is drawn although the mouse stands still


def test_esc_cancels_and_changes_nothing(operator, interface, image):
    run = operator(image.name, apply="NODES")
    run.invoke(interface, None)
    assert run.modal(interface, ESC) == {"RUNNING_MODAL"}
    assert drive(run, interface) == {"CANCELLED"}
    assert "Canceling" in interface.status
    assert run.reports == [("INFO", "Canceled; nothing was changed")]
    assert "camera_response" not in image
    assert not bpy.data.node_groups
    assert interface.timers == []
    assert interface.status[-1] is None


def test_a_cancelled_bake_leaves_no_files(operator, interface, addon, tmp_path, codes, monkeypatch):
    for number in range(8):
        write_image(tmp_path / f"shot.{number:04d}.png", codes)
    image = load_sequence(tmp_path / "shot.0000.png")
    run_now(image, "NODES")
    run = operator(image.name, apply="BAKE")
    run.needs_estimate = True
    run.invoke(interface, None)
    deadline = time.monotonic() + 30
    while not list(tmp_path.rglob("*.exr")) and run._run.task.is_alive() and time.monotonic() < deadline:
        time.sleep(0.001)
    run.modal(interface, ESC)
    assert drive(run, interface) == {"CANCELLED"}
    assert not list(tmp_path.rglob("*.exr"))
    assert image.camera_response_settings.apply == "NODES"


@pytest.mark.parametrize(("is_removed", "words"), [(False, "plate.png"), (True, "removed meanwhile")])
def test_errors_are_reported_once(operator, interface, image, plate_file, is_removed, words):
    run = operator(image.name, apply="NODES")
    plate_file.write_bytes(plate_file.read_bytes() if is_removed else b"no picture")
    run.invoke(interface, None)
    if is_removed:
        bpy.data.images.remove(image)
    assert drive(run, interface) == {"CANCELLED"}
    ((kind, text),) = run.reports
    assert kind == "ERROR"
    assert words in text
    assert interface.timers == []
    assert not bpy.data.node_groups


def test_closing_blender_stops_the_run(operator, interface, image):
    run = operator(image.name, apply="NODES")
    run.invoke(interface, None)
    run.cancel(interface)
    assert interface.timers == []
    run._run.task.join(30)
    assert not run._run.task.is_alive()


def test_another_workspace_keeps_its_status_text(operator, interface, image):
    run = operator(image.name, apply="ESTIMATE")
    run.invoke(interface, None)
    other = Interface()  # the user has changed the workspace
    assert drive(run, other) == {"FINISHED"}
    assert interface.status[-1] is None
    assert other.status == other.timers == []

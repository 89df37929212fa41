"""The run that is under way: one at a time, its progress and how seldom it is drawn, Cancel, a disabled add-on."""

import threading
import time

import pytest

from .helpers import bpy, drawn_in, operators


class Waiting:
    """A job that waits for its end to be allowed, and reports the progress that it is given."""

    def __init__(self):
        self.end, self.progress = threading.Event(), None

    def __call__(self, progress):
        self.progress = progress
        assert self.end.wait(30)
        progress(1, 1)


@pytest.fixture
def waiting(interface):
    """A run under way, and its job."""
    from blender_addon.ui import running

    job = Waiting()
    run = running.start(interface, "plate", job)
    while job.progress is None:
        time.sleep(0.001)
    yield run, job
    job.end.set()
    run.task.join(30)


def test_the_progress_is_drawn_only_if_it_changed_and_seldom(waiting, interface, monkeypatch):
    from blender_addon.ui import running

    run, job = waiting
    now = [time.monotonic()]
    monkeypatch.setattr(running.time, "monotonic", lambda: now[0])
    drawn = len(interface.status), len(interface.progress)
    for _ in range(5):  # nothing has changed
        now[0] += 1
        run.show()
    assert (len(interface.status), len(interface.progress)) == drawn
    for percent in range(1, 51):  # a tenth of a second each
        job.progress(percent, 100)
        now[0] += 0.1
        run.show()
    assert 2 <= len(interface.status) - drawn[0] <= 3  # in five seconds
    assert set(interface.redrawn) == {"UI"}  # never the picture
    assert "50 %" in run.text
    run.cancel()  # at once
    assert interface.status[-1] == "Canceling"


def test_one_run_at_a_time(waiting, image):
    for name in ("estimate_response", "apply_response", "copy_response", "load_lut", "add_look"):
        operator = getattr(bpy.ops.crf, name)
        assert not operator.poll()
        with pytest.raises(RuntimeError, match="plate is running"):
            operator(image=image.name)
    run, job = waiting
    assert bpy.ops.crf.cancel_run() == {"FINISHED"}
    assert run.task.cancelled.is_set()
    assert run.text == "Canceling"
    job.end.set()
    run.task.join(30)
    run.end()
    assert bpy.ops.crf.estimate_response.poll()
    assert not bpy.ops.crf.cancel_run.poll()


def test_the_panel_shows_the_progress_and_cancels(waiting, in_editor, image):
    drawn = drawn_in(image, in_editor)
    assert ("progress", 0.0, "Estimating plate ...") in drawn
    names = [name for name, _ in operators(drawn)]
    assert "crf.cancel_run" in names
    assert ("set", "enabled", False) in drawn  # the settings, which no longer count for this run
    assert ("set", "enabled", True) not in drawn
    assert "crf.estimate_response" not in names

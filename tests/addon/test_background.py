"""A function in another thread: what it returns, raises and reports; and how it is cancelled."""

import threading

import pytest

from blender_addon.work.background import BackgroundTask
from blender_addon.work.errors import CancelledError


def ended(function):
    task = BackgroundTask(function)
    task.start()
    task.join(10)
    assert not task.is_alive()
    return task


def test_it_returns_what_the_function_returns():
    task = ended(lambda progress: progress(1, 2) or "found")
    assert (task.result(), task.done, task.total, task.percent) == ("found", 1, 2, 50)


def test_it_raises_what_the_function_raises():
    with pytest.raises(ZeroDivisionError):
        ended(lambda progress: 1 / 0).result()


def test_a_function_is_cancelled_at_its_next_step():
    is_cancelled, steps = threading.Event(), []

    def function(progress):
        progress(1, 3)
        steps.append(1)
        is_cancelled.wait(10)
        progress(2, 3)
        steps.append(2)

    task = BackgroundTask(function)
    task.start()
    task.cancelled.set()
    is_cancelled.set()
    task.join(10)
    assert 2 not in steps
    with pytest.raises(CancelledError):
        task.result()

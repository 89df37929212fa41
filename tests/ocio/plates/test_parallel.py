import threading
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from crfnet.plates import linear
from crfnet.plates.frame_files import EncodedFrame, FirstFrame
from crfnet.plates.linear import finished


@pytest.mark.parametrize("workers", [1, 3])
def test_jobs_are_taken_only_when_there_is_room(workers):
    taken, ended, most = [], [], []

    def jobs():
        for number in range(30):
            taken.append(number)
            most.append(len(taken) - len(ended))
            yield number, lambda number=number: ended.append(number)

    list(finished(jobs(), workers, waiting=2))
    assert max(most) <= workers + 2


def test_closing_finishes_what_has_begun_and_drops_the_rest():
    begun, go = [], threading.Event()

    def work():
        begun.append(1)
        go.wait(5)

    jobs = [(0, lambda: None), *((number, work) for number in range(1, 9))]
    with closing(finished(jobs, 1, waiting=4)) as ended:
        assert next(ended)[0] == 0
        go.set()
    assert len(begun) < 8
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("plate")]


def test_of_large_frames_fewer_are_in_memory(monkeypatch):
    monkeypatch.setattr(linear, "cores", lambda: 16)
    sizes = [np.broadcast_to(np.uint8(0), (side, side, 3)) for side in (4000, 8000, 16000)]
    frames = [EncodedFrame(samples, 255, None, None) for samples in sizes]
    assert [linear._workers(FirstFrame(0, Path(), frame)) for frame in frames] == [8, 3, 1]

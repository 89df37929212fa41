"""What `make bench` computes, and the figures that it has kept."""

import json

import pytest

from benchmarks.costs import Cost, medians, ratio
from benchmarks.speed import PARTS, RESULTS


def test_works_take_turns_and_have_their_median_costs():
    seconds, turns = {"a": iter([3.0, 1.0, 2.0]), "b": iter([4.0, 9.0, 6.0])}, []

    def work(name):
        turns.append(name)
        return Cost(next(seconds[name]), 2.0, 5.0)

    costs = medians({name: lambda name=name: work(name) for name in seconds}, 3)
    assert turns == ["a", "b"] * 3
    assert costs == {"a": Cost(2.0, 2.0, 5.0), "b": Cost(6.0, 2.0, 5.0)}


def test_a_ratio_is_of_wall_times_and_says_that_of_processor_times_beside():
    figure = ratio("work against reference", "at most 1.4", {"work": Cost(3.0, 4.0), "reference": Cost(2.0, 1.0)})
    assert (figure.value, figure.unit, figure.limit) == (1.5, "times", "at most 1.4")
    assert figure.details["processor times"] == 4.0


@pytest.mark.parametrize("part", PARTS)
def test_the_figures_that_are_kept_say_where_and_when_they_are_of(part):
    kept = json.loads(RESULTS.read_text(encoding="utf-8"))[part]
    assert kept["runs"] >= 5
    assert all(kept[name] for name in ("date", "commit", "machine", "python"))
    assert kept["figures"]
    assert all(figure["value"] > 0 and figure["details"] for figure in kept["figures"])

"""What the add-on says: American spelling, one line, the verdict and the first warning by name."""

import dataclasses

import pytest

from blender_addon.work.wording import american, capitalized, panel_line, report_line
from crfnet.report.words import TELL_DEVICE
from crfnet_core.posterior import Verdict


@pytest.mark.parametrize(
    ("british", "expected"),
    [
        ("give it a linear colour space", "give it a linear color space"),
        ("Colours are analysed; linearised, Cancelled", "Colors are analyzed; linearized, Canceled"),
        ("/plates/grey colour.png: no colour", "/plates/grey colour.png: no color"),
        ("/colour/plate.png: a colour", "/colour/plate.png: a color"),
        ('"colour" is no color', '"colour" is no color'),
    ],
)
def test_messages_are_american_and_paths_stay(british, expected):
    assert american(british) == expected


def test_the_panel_leaves_the_figure_of_the_papers_out():
    line = "Expect the curve to be off by 1.9 % of the brightness range (E_est 0.60); gamma 2.2 is off by 10 %."
    assert panel_line(line) == "Expect the curve to be off by 1.9 % of the brightness range; gamma 2.2 is off by 10 %."


def test_the_panel_names_its_own_settings():
    line = panel_line(f"The estimate is not to be trusted{TELL_DEVICE}.")
    assert line.endswith(", or say with Taken With under Advanced which kind of camera took it, if it is a photograph.")


def test_a_report_names_the_verdict_and_the_warning(estimate, plate_file):
    found = dataclasses.replace(estimate(plate_file), verdict=Verdict.USABLE, warnings=())
    assert report_line("plate", found, "done") == "plate: the response is usable; done"
    one = dataclasses.replace(found, warnings=("gray photograph",))
    assert report_line("plate", one, "done") == "plate: the response is usable (warning: gray photograph); done"
    two = dataclasses.replace(found, warnings=("gray photograph", "noise"))
    assert "(warning: gray photograph, and 1 more)" in report_line("plate", two, "done")


def test_a_report_leaves_advice_out_so_that_it_is_not_cut(estimate, plate_file):
    warning = "no window covers the range of brightness: expect a poor estimate"
    found = dataclasses.replace(estimate(plate_file), verdict=Verdict.DO_NOT_TRUST, warnings=(warning,))
    expected = "the response is not to be trusted (warning: no window covers the range of brightness); done"
    assert report_line("plate", found, "done") == f"plate: {expected}"


@pytest.mark.parametrize("verdict", [Verdict.GOOD, Verdict.USABLE])
def test_a_picture_that_says_nothing_is_not_called_usable(estimate, plate_file, verdict):
    warning = "no window covers the range of brightness: expect a poor estimate"
    found = dataclasses.replace(estimate(plate_file), verdict=verdict, warnings=("saved by GIMP", warning))
    assert report_line("card", found, "done").startswith("card: the response is little more than the mean of cameras (")


def test_a_capital_letter_and_no_other_change():
    assert capitalized("no camera of NIKON") == "No camera of NIKON"
    assert capitalized("") == ""


def test_a_verdict_is_a_sentence(estimate, plate_file):
    for verdict in Verdict:
        found = dataclasses.replace(estimate(plate_file), verdict=verdict, warnings=())
        assert report_line("plate", found, "done").startswith("plate: the response is ")
    assert "is not to be trusted; done" in report_line("plate", found, "done")

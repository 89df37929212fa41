"""The add-on's sentences: one line, the verdict and the first warning by name, remedies in Blender's terms."""

import dataclasses

import pytest

from blender_addon.work.wording import panel_text, problem_line, report_line
from crfnet.errors import PlateError
from crfnet_core.errors import Notice
from crfnet_core.posterior import Family, Verdict


@pytest.fixture
def found(estimate, plate_file):
    return dataclasses.replace(estimate(plate_file), verdict=Verdict.USABLE, warnings=())


def test_the_panel_names_its_own_settings_and_no_figure_of_the_papers(found):
    families = {Family.UNEXPLAINED: 1.0}
    doubtful = dataclasses.replace(found, verdict=Verdict.DO_NOT_TRUST, families=families, origins=())
    text = panel_text(doubtful)
    assert text.advice.splitlines() == [
        "No camera response explains this picture.",
        "Use the file as the camera wrote it, or choose Advanced > Taken With.",
    ]
    assert not any(word in " ".join(text) for word in ("E_est", "--", "crfnet"))
    assert panel_text(found).advice == ""


def test_the_panel_has_warnings_apart(found):
    text = panel_text(dataclasses.replace(found, warnings=(Notice("gray"), Notice("clipped"))))
    assert [line[:4] for line in text.warnings.splitlines()] == ["Gray", "Most"]
    assert "gray" not in text.details


def test_an_error_has_the_remedy_in_blender():
    assert problem_line(PlateError("file_exists", path="a.exr")).endswith("; tick Overwrite")
    assert problem_line(PlateError("not_a_folder", path="a")) == str(PlateError("not_a_folder", path="a"))


def test_a_report_names_the_verdict_and_the_first_warning_in_few_words(found):
    assert report_line("plate", found, "done") == "plate: the response is usable; done"
    assert report_line("n" * 200, found, "done").startswith("n" * 22 + "..." + "n" * 23 + ": ")
    one = dataclasses.replace(found, warnings=(Notice("gray"),))
    assert report_line("plate", one, "done") == "plate: the response is usable (warning: gray or toned); done"
    two = dataclasses.replace(found, warnings=(Notice("edited", {"editor": "GIMP"}), Notice("gray")))
    assert "(warning: saved by GIMP, and 1 more)" in report_line("plate", two, "done")
    other = dataclasses.replace(found, warnings=(Notice.from_text("of {braces}"),))
    assert "(warning: of {braces})" in report_line("plate", other, "done")


def test_a_picture_that_says_nothing_is_not_called_usable(found):
    narrow = dataclasses.replace(found, warnings=(Notice("edited", {"editor": "GIMP"}), Notice("narrow_range")))
    words = "card: the response is little more than the mean of cameras ("
    assert report_line("card", narrow, "done").startswith(words)
    untrusted = dataclasses.replace(narrow, verdict=Verdict.DO_NOT_TRUST)
    assert "is not to be trusted (warning" in report_line("card", untrusted, "done")

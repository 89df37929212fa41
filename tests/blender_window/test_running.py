"""What is shown while the response is estimated, and afterwards."""

from __future__ import annotations

import time

from tests.blender_window.artist import CANCEL, COLUMNS, ESTIMATE
from tests.blender_window.base import WindowTest

#: Fraction of the sidebar's pixels that may differ where nothing is to be drawn: the highlight of a button.
HIGHLIGHT = 0.03

#: Seconds after which the report of an operator has gone from the status bar.
REPORT = 60


class TestRunning(WindowTest):
    def start_with(self, plate, *, alone=True):
        """Return an artist with a plate open, and the name of its image."""
        artist = self.start()
        return artist, artist.open(self.plate(plate), alone=alone)

    def test_the_panel_shows_the_estimate_although_the_mouse_rests(self):
        artist, _ = self.start_with("plate.jpg")
        artist.run()
        time.sleep(2)
        shown = artist.picture(artist.sidebar())
        artist.settle()
        artist.call("editors.redraw")
        artist.settle()
        drawn = artist.picture(artist.sidebar())
        self.keep(shown, "estimate_mouse_at_rest")
        self.assertLess(shown.difference(drawn), HIGHLIGHT)

    def test_the_status_bar_is_as_before_after_a_change_of_workspace(self):
        artist, _ = self.start_with("large.jpg", alone=False)
        before = artist.picture(artist.status_bar())
        artist.start()
        usual = artist.call("editors.change_workspace", "Modeling")
        artist.settle()
        artist.wait_for_end()
        artist.call("editors.change_workspace", usual)
        self.assert_status_bar_is(artist, before, "status_after_workspace")

    def test_the_status_bar_is_as_before_after_the_add_on_was_disabled(self):
        artist, _ = self.start_with("large.jpg")
        before = artist.picture(artist.status_bar())
        artist.start()
        artist.call("runs.disable")
        self.assert_status_bar_is(artist, before, "status_after_disabling")

    def test_one_run_at_a_time_which_the_panel_can_cancel(self):
        artist, _ = self.start_with("large.jpg")
        position = artist.find(ESTIMATE)
        artist.start()
        artist.screen.click(*position)
        self.assertEqual(len(artist.call("runs.running")), 1)
        self.assertFalse(artist.call("runs.can_run"))
        artist.wait_for_end()
        artist.settle()
        self.assertTrue(artist.call("runs.can_run"))

    def test_the_cancel_button_of_the_panel_cancels(self):
        artist, name = self.start_with("large.jpg")
        _, row = artist.find(ESTIMATE)
        box = artist.sidebar()
        artist.start()
        artist.press(CANCEL, (box.x + round(COLUMNS[-1] * box.width), row))  # a search would last longer than the run
        artist.wait_for_end()
        self.assertIsNone(artist.call("plates.stored", name))

    def assert_status_bar_is(self, artist, before, name):
        """Assert that the status bar becomes what it was, once the report of the operator has gone."""
        deadline = time.monotonic() + REPORT
        while time.monotonic() < deadline:
            artist.settle()
            shown = artist.picture(artist.status_bar())
            if shown == before:
                return
        self.keep(before, f"{name}_before")
        self.keep(shown, f"{name}_after")
        self.fail("the status bar is not as before")

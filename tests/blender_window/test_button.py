"""The button in the Image Editor: its numbers equal the `crfnet` command's, Esc and undo leave nothing behind."""

from __future__ import annotations

from tests.blender_window.artist import APPLY
from tests.blender_window.base import BAKED, NODES, WindowTest, report

PLATE = "plate.jpg"

#: The kinds of the linked nodes of a comp that two clicks make.
READY_COMP = ["ALPHAOVER", "GROUP", "GROUP_OUTPUT", "IMAGE", "R_LAYERS", "SCALE", "VIEWER"]


class TestButton(WindowTest):
    def setUp(self):
        super().setUp()
        self.artist = self.start()
        self.name = self.artist.open(self.plate(PLATE))

    def test_the_stored_estimate_is_that_of_the_command(self):
        self.artist.apply()
        self.artist.settle()
        self.keep(self.artist.picture(), "button_nodes")
        stored, expected = self.artist.call("plates.stored", self.name), report(PLATE)
        self.assertEqual(stored["verdict"], expected["verdict"])
        self.assertAlmostEqual(stored["uncertainty"], expected["uncertainty"], places=4)
        for found, wanted in zip(stored["brightness"], expected["response"]["brightness"], strict=True):
            self.assertAlmostEqual(found, wanted, places=4)

    def test_two_clicks_put_the_render_over_the_linear_plate_and_one_undo_takes_all_back(self):
        self.artist.run()
        before = self.artist.call("plates.state")
        self.artist.run(APPLY)
        after = self.artist.call("plates.state")
        self.assertEqual(self.artist.call("plates.comp"), READY_COMP)
        self.assertTrue(after["film"])
        rendered = self.artist.call("plates.render", self.name, str(self.folder / "rendered.exr"))
        self.assert_linear(self.artist, rendered, PLATE, NODES, beside="Cube")
        self.assertGreater(self.difference(self.artist, rendered, PLATE), 0.1, "the cube is not rendered")
        self.press_keys("ctrl+z")
        self.assertEqual(self.artist.call("plates.state"), before)
        self.press_keys("ctrl+shift+z")
        self.assertEqual(self.artist.call("plates.state"), after)

    def test_baked_files_hold_the_linear_values_of_the_command_and_are_shown_in_place(self):
        self.artist.call("plates.choose", self.name, apply="BAKE", depth="float")
        self.artist.call("editors.pan", 37, -21)
        view = self.artist.call("editors.view")
        self.artist.apply()
        self.artist.settle()
        self.assert_view(self.artist, view)
        self.keep(self.artist.picture(), "button_bake")
        (baked,) = (self.folder / "project").glob("*.exr")
        self.assert_linear(self.artist, baked, PLATE, BAKED)

    def test_esc_cancels_and_changes_nothing(self):
        name = self.artist.open(self.plate("large.jpg"))
        before = self.artist.call("plates.state")
        self.artist.start()
        self.artist.screen.key("Escape")
        self.artist.wait_for_end()
        self.assertEqual(self.artist.call("plates.state"), before)
        self.assertIsNone(self.artist.call("plates.stored", name))

    def press_keys(self, keys):
        """Press keys over the picture, and wait until Blender has drawn."""
        self.artist.settle()
        self.artist.screen.key(keys)
        self.artist.settle()

"""Apply As: Compositor Nodes. Each plate keeps its own response, and none is linearized twice."""

from __future__ import annotations

from tests.blender_window.artist import APPLY
from tests.blender_window.base import NODES, WindowTest


class TestNodes(WindowTest):
    def applied(self, artist, plate):
        """Insert the node group of a plate by the button; return the name of its image."""
        name = artist.open(plate)
        artist.call("plates.choose", name, apply="NODES")
        artist.run()
        return name

    def test_two_photographs_of_one_name_keep_their_own_response(self):
        artist = self.start()
        names = [self.applied(artist, self.plate(plate)) for plate in ("a/IMG_0001.jpg", "b/IMG_0001.jpg")]
        for name, plate in zip(names, ("a/IMG_0001.jpg", "b/IMG_0001.jpg"), strict=True):
            rendered = artist.call("plates.render", name, str(self.folder / f"{plate[0]}.exr"))
            with self.subTest(plate=plate):
                self.assert_linear(artist, rendered, plate, NODES)

    def test_a_node_in_between_does_not_linearize_twice(self):
        artist = self.start()
        name = self.applied(artist, self.plate("plate.jpg"))
        for kind in ("NodeReroute", "CompositorNodeBrightContrast"):
            with self.subTest(kind=kind):
                artist.call("plates.put_between", name, kind)
                artist.run(APPLY)
                self.assertEqual(len(artist.call("plates.groups_behind", name)), 1)
        rendered = artist.call("plates.render", name, str(self.folder / "rendered.exr"))
        self.assert_linear(artist, rendered, "plate.jpg", NODES)

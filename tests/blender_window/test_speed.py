"""Estimating by the button takes hardly longer than by a script."""

from __future__ import annotations

import statistics

from tests.blender_window.base import WindowTest

#: How often each is measured, in turns, and the most that the button may take, as a multiple of the script's time.
ROUNDS, MOST = 4, 1.3


class TestSpeed(WindowTest):
    def test_a_plate_of_12_megapixels(self):
        artist = self.start()
        name = artist.open(self.plate("large.jpg"))
        by_script, by_button = [], []
        for number in range(ROUNDS + 1):
            for times, way in ((by_script, self.script), (by_button, self.button)):
                times.append(way(artist, name, self.folder / f"{way.__name__}{number}"))
        del by_script[0], by_button[0]  # the first loads the network
        for words, times in (("by script", by_script), ("by button", by_button)):
            print(f"\n  12 megapixels {words}: " + ", ".join(f"{seconds:.2f}" for seconds in times) + " s", end="")
        ratio = statistics.median(by_button) / statistics.median(by_script)
        print(f"\n  ratio of the medians: {ratio:.2f}", flush=True)
        self.assertLessEqual(ratio, MOST)

    def script(self, artist, name, folder):
        """Return how long a script's run takes, in seconds."""
        return artist.call("runs.script", image=name, apply="EXPORT", folder=str(folder))

    def button(self, artist, name, folder):
        """Return how long it takes from the click to the end of the run, in seconds."""
        artist.call("plates.choose", name, apply="EXPORT", folder=str(folder))
        artist.settle()
        return artist.run()

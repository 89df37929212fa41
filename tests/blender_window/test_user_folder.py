"""Installed into an empty home, and uninstalled without a trace."""

from __future__ import annotations

from tests.blender_window.base import WindowTest, package

#: What the graphics driver and Blender itself write, the latter about the display and about all extensions.
NOT_OURS = (".cache/mesa", "blender/config/platform_support.txt", "blender/extensions/.cache/compat.dat")


class TestUserFolder(WindowTest):
    is_installed = False
    maxDiff = None

    def test_uninstalling_leaves_nothing_in_the_home(self):
        artist = self.start()
        artist.value("bpy.ops.wm.save_userpref()")
        artist.blender.quit()
        before = self.files()
        artist = self.start()
        self.assertTrue(artist.call("runs.install", str(package())))
        name = artist.open(self.plate("plate.jpg"))
        artist.call("plates.choose", name, apply="EXPORT", folder=str(self.folder / "look"))
        artist.apply()
        artist.call("runs.uninstall")
        artist.blender.quit()
        artist = self.start()
        artist.blender.quit()
        self.assertEqual(sorted(self.files() - before), [])
        self.assertFalse((self.home / "blender" / "datafiles" / "colormanagement").exists())

    def files(self):
        """Return the paths of the files in the home, but for those that are `NOT_OURS`."""
        found = (path.relative_to(self.home).as_posix() for path in self.home.rglob("*") if not path.is_dir())
        return {name for name in found if not name.startswith(NOT_OURS)}

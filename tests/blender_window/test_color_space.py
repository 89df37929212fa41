"""Apply As: Color Space. After a restart the plate has it and no other file; Restore leaves Blender's own config."""

from __future__ import annotations

import shutil

from tests.blender_window.base import COLOR_SPACE, WindowTest

#: The color space of a photograph in Blender's own config.
USUAL = "sRGB"

SPACE = "bpy.data.images[{!r}].colorspace_settings.name"
SPACES = (
    "[item.identifier for item in bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties['name'].enum_items]"
)
VIEW = "bpy.context.scene.view_settings.view_transform"


class TestColorSpace(WindowTest):
    def applied(self, plate, **options):
        """Apply a color space to a plate by the button, save, and end Blender; return the image's name and the file."""
        artist = self.start()
        name = artist.open(plate, **options)
        artist.call("plates.choose", name, apply="COLORSPACE")
        artist.run()
        file = self.save(artist)
        artist.blender.quit()
        return name, file

    def test_the_plate_has_it_after_a_restart(self):
        name, file = self.applied(self.plate("plate.jpg"))
        artist = self.start(file)
        self.assertNotEqual(artist.value(SPACE.format(name)), USUAL)
        self.assertEqual(artist.value(VIEW), "AgX")
        self.assert_linear(
            artist, artist.call("plates.decoded", name, str(self.folder / "decoded.exr")), "plate.jpg", COLOR_SPACE
        )

    def test_restore_leaves_blenders_own_config(self):
        artist = self.start()
        own = artist.value(SPACES), artist.value(VIEW)
        artist.blender.quit()
        _, file = self.applied(self.plate("plate.jpg"))
        artist = self.start(file)
        artist.value("bpy.ops.crf.restore_config('EXEC_DEFAULT')")
        artist.blender.quit()
        artist = self.start()
        self.assertEqual((artist.value(SPACES), artist.value(VIEW)), own)
        self.assertEqual(own[1], "AgX")

    def test_a_sequence_named_by_numbers_leaves_other_files_alone(self):
        frames = self.plate("numbers")
        names = tuple(sorted(path.name for path in frames.iterdir()))
        self.applied(frames / names[0], names=names, sequence=True)
        other = self.plate("plate.jpg", to="elsewhere/holiday.jpg")
        artist = self.start()
        self.assertEqual(artist.value(SPACE.format(artist.open(other))), USUAL)

    def test_a_photograph_of_the_same_name_in_another_folder_is_left_alone(self):
        self.applied(self.plate("a/IMG_0001.jpg"))
        other = self.plate("c/IMG_0001.jpg")
        artist = self.start()
        self.assertEqual(artist.value(SPACE.format(artist.open(other))), USUAL)

    def test_the_color_space_of_a_photograph_of_the_same_name_stays(self):
        first, file = self.applied(self.plate("a/IMG_0001.jpg"))
        shutil.move(file, file.with_name("first.blend"))
        self.applied(self.plate("b/IMG_0001.jpg"))
        artist = self.start(file.with_name("first.blend"))
        decoded = artist.call("plates.decoded", first, str(self.folder / "decoded.exr"))
        self.assert_linear(artist, decoded, "a/IMG_0001.jpg", COLOR_SPACE)

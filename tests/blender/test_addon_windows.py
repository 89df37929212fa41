"""The analysed windows over the plate: where they lie, in which frame, and when they are drawn.

Whether they are seen cannot be tested here: without a window Blender draws nothing.
"""

from types import SimpleNamespace

import numpy as np
import pytest

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")


@pytest.fixture
def windows(addon):
    from blender_addon.ui.image_editor import analyzed_windows

    return analyzed_windows


def edges_of(window, size):
    """The edges of the pixels that a window reads, from the pixels themselves: left, bottom, right, top."""
    y, x = np.mgrid[: size[1], : size[0]]
    columns, rows = window.cut(x), window.cut(y)
    return (
        columns.min() / size[0],
        1 - (rows.max() + 1) / size[1],
        (columns.max() + 1) / size[0],
        1 - rows.min() / size[1],
    )


def test_the_outlines_enclose_the_pixels_of_the_windows(windows, image):
    from blender_addon.scene import stored_estimate

    size = tuple(image.size)
    corners, agrees = windows.rectangles(image, 0, size)
    found = stored_estimate.restored(image).windows
    assert len(corners) == len(found) > 0
    for rectangle, agreeing, window in zip(corners, agrees, found, strict=True):
        left, bottom, right, top = edges_of(window.window, size)
        np.testing.assert_allclose(rectangle, [(left, bottom), (right, bottom), (right, top), (left, top)], atol=1e-12)
        assert agreeing == window.kept


def test_windows_that_are_sampled_sparsely_are_as_large_as_what_they_span(windows, image):
    from crfnet_core.statistics.windows import Window

    image["camera_response"]["window_places"] = [100, 40, 3, 200, 0, 0, 1, 256]
    image["camera_response"]["window_photos"] = [0, 1]
    image["camera_response"]["window_kept"] = [0, 1]
    size = (2000, 1000)
    for photo, window in enumerate((Window(100, 40, 3, 200), Window(0, 0, 1, 256))):
        ((lower_left, _, upper_right, _),), (agrees,) = windows.rectangles(image, photo, size)
        np.testing.assert_allclose([*lower_left, *upper_right], edges_of(window, size), atol=1e-12)
        assert agrees == bool(photo)
    assert len(windows.rectangles(image, 2, size)[0]) == 0


def test_the_sides_are_drawn_where_the_view_shows_them(windows):
    corners = np.array([[(0, 0), (0.5, 0), (0.5, 1), (0, 1)]])
    ends = windows.segments(corners, lambda x, y, clip: (10 + 100 * x, 20 + 200 * y))
    sides = {frozenset(pair) for pair in zip(ends[::2], ends[1::2], strict=True)}
    places = [(10, 20), (60, 20), (60, 220), (10, 220)]
    assert sides == {frozenset(pair) for pair in zip(places, places[1:] + places[:1], strict=True)}
    assert len(ends) == 8
    assert windows.segments(corners[:0], None) == []


def test_they_are_drawn_while_the_switch_is_on(windows, image, tmp_path):
    manager = bpy.context.window_manager
    assert not manager.camera_response_shows_windows
    assert windows._handler is None
    manager.camera_response_shows_windows = True
    assert windows._handler is not None
    manager.camera_response_shows_windows = False
    assert windows._handler is None
    manager.camera_response_shows_windows = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    assert windows._handler is None
    assert not bpy.context.window_manager.camera_response_shows_windows


def test_disabling_the_addon_ends_them(windows, image):
    import addon_utils

    bpy.context.window_manager.camera_response_shows_windows = True
    addon_utils.disable("blender_addon")
    assert windows._handler is None
    assert not hasattr(bpy.context.window_manager, "camera_response_shows_windows")
    addon_utils.enable("blender_addon")
    assert not bpy.context.window_manager.camera_response_shows_windows


def test_the_switch_is_drawn_where_there_are_windows(image, in_editor):
    from .test_addon_panel import drawn_in

    def is_drawn():
        drawn = drawn_in(image, in_editor)
        return "camera_response_shows_windows" in [entry[2] for entry in drawn if entry[0] == "prop"]

    assert is_drawn()
    image["camera_response"]["origin"] = "From another plate"  # which has the windows
    assert not is_drawn()


def test_of_a_sequence_they_are_those_of_the_frame_shown(windows, addon, plate_file, in_editor):
    from .test_addon_panel import drawn_in, labels

    frames = [plate_file.with_name(f"shot.{number:04d}.png") for number in (0, 1, 2)]
    for path in frames:
        path.write_bytes(plate_file.read_bytes())
    image = bpy.data.images.load(str(frames[0]))
    image.source = "SEQUENCE"
    bpy.ops.crf.estimate_response(image=image.name)
    assert image["camera_response"]["photos"].split() == [path.name for path in frames]
    bpy.context.window_manager.camera_response_shows_windows = True
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        assert space.image_user.frame_current == 0  # Blender without a window shows no other frame
        for names, shown in ((frames, 0), (frames[::-1], 2), (frames[1:], None)):
            image["camera_response"]["photos"] = "\n".join(path.name for path in names)
            assert windows.photo_shown(image, space.image_user) == shown
    assert "Not in this frame: the windows are in 0001, 0002." in " ".join(labels(drawn_in(image, in_editor)))
    image["camera_response"]["photos"] = "shot.0020.png\nshot.0040.png\nother1.jpg"
    assert "Not in this frame: the windows are in 0020, 0040." in " ".join(labels(drawn_in(image, in_editor)))


def test_of_a_movie_too(windows):
    movie = {"camera_response": {"photos": "clip.0001.png\nclip.0007.png\nphoto.jpg"}}
    shown = type("Movie", (dict,), {"source": "MOVIE", "filepath": "//clip.mp4"})(movie)
    found = [windows.photo_shown(shown, SimpleNamespace(frame_current=frame)) for frame in (1, 7, 8)]
    assert found == [0, 1, None]


def test_a_window_is_as_large_as_the_estimator_says(windows):
    from crfnet_core.statistics.windows import WINDOW_SIZE

    assert windows.WINDOW_SIZE == WINDOW_SIZE

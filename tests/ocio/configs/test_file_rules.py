"""Which files are a plate's: full names in upper and lower case, frames, and no names that cameras give again."""

import re

import pytest

from crfnet.configs.file_rules import (
    FileClaim,
    add_file_rules,
    is_counter_name,
    linear_patterns,
    plate_pattern,
    rule_regex,
)
from crfnet.configs.plate_color_space import PlateColorSpace, add_plate_color_spaces
from crfnet.configs.portable import portable_config
from crfnet.configs.sources import find_config
from tests.helpers.configs import loaded
from tests.helpers.folders import written
from tests.helpers.looks import STUDIO, add, space_of, write_look


def matched_space(pattern, path):
    """The color space that OpenColorIO's own rules give a file."""
    config = portable_config([])
    add_file_rules(config, [FileClaim("plate", "ACEScct", (pattern,))])
    return config.getColorSpaceFromFilepath(path)[0]


@pytest.mark.parametrize(
    ("pattern", "matching", "others"),
    [
        (
            "plate01.jpg",
            ["plate01.jpg", "PLATE01.JPG", "/a/b/Plate01.jpg", r"C:\a\plate01.JPG", "../plate01.jpg"],
            ["plate01.jpeg", "aplate01.jpg", "plate01.jpg.exr", "plate01.jpg/b.jpg", "plate011.jpg", "plate01xjpg"],
        ),
        ("shot.#.png", ["shot.1.png", "a/SHOT.01001.PNG"], ["shot.png", "shot..png", "shot.v2.png", "shot.1.2.png"]),
        ("shot.#.png", ["shot.-0001.png"], ["shot.--1.png", "shot-0001.png"]),
        ("shot#.png", ["shot0001.png"], ["shot-0001.png"]),
        ("Größe (1).jpg", ["größe (1).JPG".replace("ö", "ö"), "x/GRÖSSE (1).jpg"], ["Größe 1.jpg", "Größe (1)jpg"]),
        ("a+b[1]^$|{2}.jpg", ["A+B[1]^$|{2}.JPG"], ["aab1.jpg"]),
        ("*?\\[#].jpg", ["*?\\#.jpg"], ["*?\\1.jpg", "a?\\#.jpg", "*b\\#.jpg", "*?/#.jpg"]),
    ],
)
def test_a_pattern_holds_for_full_names(pattern, matching, others):
    assert {path: matched_space(pattern, path) for path in matching} == dict.fromkeys(matching, "ACEScct")
    assert "ACEScct" not in [matched_space(pattern, path) for path in others]
    assert all(re.fullmatch(rule_regex([pattern]), path) for path in matching)


LINEAR = "Linear Rec.709 (sRGB)"

CAMERA_NAMES = (
    "IMG_0042.JPG img_e0042.heic DSC_1234.NEF DSCF0001.jpg DSC01234.ARW _MG_7081.CR2 P1010001.JPG GOPR0123.JPG"
    " DJI_0001.jpg 0001.png 12-3.png image.jpg photo_2.jpg photo(2).jpg IMG_0042.0001.jpg IMG_0042.#.jpg"
)


@pytest.mark.parametrize("name", CAMERA_NAMES.split())
def test_names_of_cameras_are_many_peoples(name):
    assert is_counter_name(name)


@pytest.mark.parametrize(
    "name", ["plate01.jpg", "shot.0001.png", "sh010_bg_v002.jpg", "beach.jpg", "IMG_0042_graded.jpg"]
)
def test_names_that_somebody_gave_are_his(name):
    assert not is_counter_name(name)


@pytest.mark.parametrize(
    ("name", "pattern"),
    [
        *((name, name) for name in ("plate01.jpg", "shot.1.jpg", "shot.๒๓.jpg", "noextension", ".hidden")),
        *(("shot.0001.jpg", "shot.#.jpg"), ("shot.-0001.jpg", "shot.#.jpg")),
        ("a#1.0001.jpg", "a[#]1.#.jpg"),
    ],
)
def test_a_frame_stands_for_all_frames(name, pattern):
    assert plate_pattern(name) == pattern


def test_the_linear_files_of_a_plate_are_known_by_name_and_as_frames():
    names = ["shot.0001_linear.exr", "shot.0002_linear.exr", "other_linear.exr"]
    assert linear_patterns("shot.0001", names) == ("shot.#_linear.exr", "other_linear.exr", "shot.#.exr")
    assert linear_patterns("frame_0001", plates="frame_#") == ()  # without a suffix


def test_linear_files_for_which_the_base_has_no_space_are_named(studio, tmp_path):
    (config := loaded(studio)).removeColorSpace("Linear AdobeRGB")
    studio.write_text(config.serialize())
    done = add(studio, tmp_path / "new", write_look(tmp_path / "look", interop_id="lin_adobergb_scene"))
    assert done.without_rule == ("plate01_linear.exr",)


def test_linear_frames_have_a_rule_where_the_base_knows_linear_files_by_their_names_only(tmp_path):
    base = find_config(STUDIO).config
    (rules := base.getFileRules()).insertRule(0, "linear", LINEAR, "*_linear*", "exr")
    base.setFileRules(rules)
    (tmp_path / "base.ocio").write_text(base.serialize())
    done = add(tmp_path / "base.ocio", tmp_path / "new", write_look(tmp_path / "look", ["bg.0001.jpg"]))
    names = ("bg.0002.exr", "bg.0002_linear.exr", "BG.0002_LINEAR.EXR", "other.0002.exr")
    assert [space_of(loaded(done.path), name) for name in names] == [LINEAR] * 3 + ["ACES2065-1"]


@pytest.mark.parametrize("order", ["abc", "acb", "bca", "cab"])
def test_a_sequence_and_another_shots_frame_of_its_names_get_no_rule(tmp_path, order):
    names = {"a": "skyline_001.png", "b": "skyline_001.png", "c": "skyline_002.png"}
    sequences = {"a": "skyline_#.png"}
    looks = [write_look(tmp_path / each, [names[each]], sequence=sequences.get(each, "")) for each in order]
    done = add(STUDIO, tmp_path / "show", *looks)
    assert {space_of(loaded(done.path), f"skyline_{number}.png") for number in ("001", "002", "3")} == {
        "sRGB - Display"
    }
    assert set(done.without_rule) == {"skyline_#.png", "skyline_001.png", "skyline_002.png"}


def test_a_rule_of_an_earlier_crfnet_is_of_the_same_files(tmp_path):
    one = add(STUDIO, tmp_path / "one", write_look(tmp_path / "a", ["sky.0001.png"]))
    one.path.write_text(one.path.read_text().replace("-?[0-9]+", "[0-9]+"))
    two = add(one.path, tmp_path / "two", write_look(tmp_path / "b", ["sky.0001.png"]))
    assert space_of(loaded(two.path), "sky.0001.png") == "sRGB - Display"


def test_files_of_several_plates_follow_the_rules_of_the_base(tmp_path):
    base = portable_config([])
    (rules := base.getFileRules()).insertRule(0, "by shot", "ACEScct", ".*sh010.*")
    base.setFileRules(rules)
    one = add(written(tmp_path / "base.ocio", base.serialize()), tmp_path / "one", write_look(tmp_path / "a"))
    result = loaded(add(one.path, tmp_path / "two", write_look(tmp_path / "b")).path)
    assert [space_of(result, f"/{shot}/plate01.jpg") for shot in ("sh010", "sh020")] == ["ACEScct", "sRGB"]


@pytest.mark.parametrize("interop_id", ["lin_ap1_scene", "lin_ap0_scene", "unknown"])
@pytest.mark.parametrize("order", [1, -1])
def test_linear_files_of_one_name_and_different_spaces_get_no_rule(tmp_path, interop_id, order):
    looks = [write_look(tmp_path / "a", interop_id=interop_id), write_look(tmp_path / "b")][::order]
    together = add(STUDIO, tmp_path / "show", *looks)
    one = add(STUDIO, tmp_path / "one", looks[0])
    for done in (together, add(one.path, tmp_path / "two", looks[1])):
        assert space_of(loaded(done.path), "plate01_linear.exr") == "ACES2065-1"  # as all OpenEXR files
        assert "plate01_linear.exr" in done.without_rule


def test_a_plate_loses_the_rule_of_those_files_only_that_another_has(tmp_path):
    one = add(STUDIO, tmp_path / "one", write_look(tmp_path / "a", ["sky.0001.png", "Größe.png", "c#.png"]))
    two = add(one.path, tmp_path / "two", write_look(tmp_path / "b", ["sky.0001 linear.png", "größe.png"]))
    names = ("sky.0001 linear.png", "sky.0002.png", "C#.PNG", "größe.png", "GRÖSSE.PNG")
    spaces = ["CRF sky.0001 linear", *["CRF sky.0001"] * 2, *["sRGB - Display"] * 2]
    assert [space_of(loaded(two.path), name) for name in names] == spaces
    assert two.without_rule == ("größe.png",)


@pytest.mark.parametrize(
    ("one", "other", "is_shared"),
    [
        *(("v2#.png", "v20001.png", True), ("v2#.png", "v#3.png", True), ("v2#.png", "v1#.png", False)),
        ("KAPI.jpg", "kap\u0131.jpg", True),  # I is the upper case of both letters
        ("caf\u00e9.jpg", "cafe\u0301.jpg", True),  # two forms of Unicode
    ],
)
def test_patterns_are_shared_that_have_a_file_in_common(one, other, is_shared):
    claims = [FileClaim("a", "ACEScct", (one,)), FileClaim("b", "sRGB", (other,))]
    assert bool(add_file_rules(portable_config([]), claims)) == is_shared


def test_a_name_that_cameras_repeat_is_also_the_one_of_an_earlier_plate():
    first, second = (PlateColorSpace(name, "a.spi1d", file_patterns=("IMG_0042.JPG",)) for name in ("CRF a", "CRF b"))
    add_plate_color_spaces(config := portable_config([first]), [second], has_counters=False)
    assert space_of(config, "IMG_0042.JPG") == "sRGB"


def test_hundreds_of_photographs_have_rules_and_no_other_file(tmp_path):
    names = [f"still {number}x.jpg" for number in range(250)]
    result = loaded(add(STUDIO, tmp_path / "show", write_look(tmp_path / "look", names)).path)
    assert {space_of(result, name) for name in names} == {"CRF still 0x"}
    assert [space_of(result, f"{name}_linear.exr") for name in ("still 249x", "other")] == [LINEAR, "ACES2065-1"]


def test_a_movie_has_rules_for_its_file_and_its_linear_frames(tmp_path):
    look = write_look(tmp_path / "look", ["clip.mp4 frame 1", "clip.mp4 frame 9"], interop_id="lin_ap1_scene")
    result = loaded(add(STUDIO, tmp_path / "show", look).path)
    assert space_of(result, "/x/clip.mp4") == "CRF clip"
    assert [space_of(result, path) for path in ("clip.0001.exr", "clip_linear.exr")] == ["ACEScg"] * 2


class TestRules:
    def test_a_cameras_own_name_gets_no_rule(self, tmp_path):
        frames = write_look(tmp_path / "frames", ["shot_0001.png"], sequence="shot_#.png")
        done = add(STUDIO, tmp_path / "show", write_look(tmp_path / "look", ["IMG_0042.JPG"]), frames)
        assert space_of(loaded(done.path), "IMG_0042.JPG") == "sRGB - Display"
        assert space_of(loaded(done.path), "img_0042_linear.exr") == "Linear Rec.709 (sRGB)"
        assert set(done.without_rule) == {"IMG_0042.JPG", "shot_#.png", "shot_#.exr"}

    @pytest.mark.parametrize("interop_id", ["lin_rec709_scene", "lin_ap1_scene"])
    def test_a_sequence_has_rules_for_every_frame(self, tmp_path, interop_id):
        look = write_look(tmp_path / "look", ["sky.0001.png", "sky.0090.png", "wall.png"], interop_id=interop_id)
        names = ["skyline_001.png", "skyline_090.png"]
        other = write_look(tmp_path / "other", names, interop_id=interop_id, sequence="skyline_#.png")
        result = loaded(add(STUDIO, tmp_path / "show", look, other).path)
        assert space_of(result, "skyline_050.png") == "CRF skyline_001"
        assert {space_of(result, path) for path in ("sky.0099.png", "a/WALL.png")} == {"CRF sky.0001"}
        assert space_of(result, "sky.v2.png") == "sRGB - Display"
        linear = result.getColorSpace(interop_id).getName()
        for path in ("sky.0099_linear.exr", "wall_linear.exr", "sky.0099.exr", "skyline_050.exr"):
            assert space_of(result, path) == linear

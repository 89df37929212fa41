"""Plates in a copy of somebody's config: the base stays, and everything of it means the same in the copy."""

import re
from unittest.mock import Mock

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs import derived
from crfnet.configs.files import load_config
from crfnet.configs.plate_color_space import plates_in_config
from crfnet.configs.reference_space import REC709_TO_AP0
from crfnet.errors import ConfigError, PlateError
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet.luts.rgb_lut import lut_identity
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import converted, loaded
from tests.helpers.folders import listed, tree
from tests.helpers.looks import LUT, NAME, OTHER_LUT, STUDIO, add, all_names, space_of, write_look
from tests.helpers.refusals import refusal_of, refused

BUILT_IN = [entry[0] for entry in OCIO.BuiltinConfigRegistry().getBuiltinConfigs()]

THIRD_LUT = inverse_response_lut(ResponseCurve.gamma(2.6))

CODES = np.linspace(0, 1, 30, dtype=np.float32).reshape(-1, 3)


def conversions(config):
    """Return what a config makes of gray and colored pixels: through all spaces, and all views of all displays."""
    scene = config.getColorSpaceNames(OCIO.SEARCH_REFERENCE_SPACE_SCENE, OCIO.COLORSPACE_ALL)
    names = [name for name in scene if "CRF" not in name and not config.getColorSpace(name).isData()]
    pixels = {name: converted(config, name, "scene_linear", CODES) for name in names}
    for display in config.getDisplaysAll():
        for view in config.getViews(display):
            shown = CODES.copy()
            processor = config.getProcessor("scene_linear", display, view, OCIO.TRANSFORM_DIR_FORWARD)
            processor.getDefaultCPUProcessor().applyRGB(shown)
            pixels[f"{display} {view}"] = shown
    return pixels


def assert_same(result, expected):
    assert result.keys() == expected.keys()
    for name, pixels in expected.items():
        np.testing.assert_array_equal(result[name], pixels, err_msg=name)


@pytest.mark.parametrize("name", BUILT_IN)
def test_all_of_a_built_in_config_is_kept_the_plate_is_right_in_aces_and_only_its_files_change(
    name, small_look, tmp_path
):
    base = OCIO.Config.CreateFromBuiltinConfig(name)
    result = loaded(add(name, tmp_path / "show", small_look).path)
    assert all_names(result) == all_names(base)
    pixels = np.random.default_rng(0).uniform(0, 1, (500, 3)).astype(np.float32)
    expected = LUT.apply(pixels) @ np.transpose(REC709_TO_AP0)
    np.testing.assert_allclose(converted(result, NAME, "aces_interchange", pixels), expected, atol=1e-5)
    assert [space_of(result, path) for path in ("/a/plate01.jpg", "PLATE01.JPG")] == [NAME] * 2
    for path in ("/a/plate01_linear.exr", "Plate01_Linear.EXR"):
        assert result.getColorSpace(space_of(result, path)).getName().startswith("Linear Rec.709")
    others = "plate01.0001.exr x/b.jpg plate01.png plate02.jpg aplate01.jpg plate01.jpg.exr b.mov"
    for path in others.split():
        assert space_of(result, path) == space_of(base, path)


class TestBase:
    def test_it_stays_as_it_is_and_all_of_it_means_the_same(self, studio, small_look, tmp_path):
        before = tree(studio.parent)
        done = add(studio, tmp_path / "new", small_look)
        assert tree(studio.parent) == before
        assert listed(tmp_path / "new") == [path.name for path in done.files]
        assert [path.parent for path in done.files] == [tmp_path / "new"] * 2
        result = loaded(done.path)
        assert all_names(result) == all_names(loaded(studio))
        assert_same(conversions(result), conversions(loaded(studio)))
        home = str(studio.parent)
        assert list(result.getSearchPaths()) == [f"{home}/luts", f"{home}/$SHOW/luts", "$SHOW/luts", "."]

    @pytest.mark.parametrize("paths", [[".", "luts"], ["luts", "."], ["sub/../luts"], ["more", ".", "luts"], []])
    @pytest.mark.parametrize("lut", [THIRD_LUT, None])
    def test_a_lut_name_of_two_folders_stays_the_same_file(self, studio, small_look, tmp_path, paths, lut):
        (studio.parent / "sub").mkdir()
        write_lut(studio.parent / "film.spi1d", LUT)
        if lut is not None:
            (studio.parent / "more").mkdir()
            write_lut(studio.parent / "more" / "film.spi1d", lut)
        config = loaded(studio)
        config.clearSearchPaths()
        for path in paths:
            config.addSearchPath(path)
        studio.write_text(config.serialize())
        assert_same(conversions(loaded(add(studio, tmp_path / "new", small_look).path)), conversions(loaded(studio)))

    @pytest.mark.parametrize("path", ["$WHERE", "luts/$DEEP/../../../other"])
    @pytest.mark.parametrize("is_absolute", [True, False])
    def test_paths_with_a_variable_mean_the_same_folder(self, studio, small_look, tmp_path, is_absolute, path):
        (tmp_path / "new" / "other").mkdir(parents=True)
        write_lut(tmp_path / "new" / "other" / "film.spi1d", THIRD_LUT)
        (studio.parent / "other").mkdir()
        write_lut(studio.parent / "other" / "film.spi1d", LUT)
        config = loaded(studio)
        config.clearSearchPaths()
        config.addSearchPath(path)
        config.addEnvironmentVar("DEEP", "a/b")
        config.addEnvironmentVar("WHERE", str(studio.parent / "other") if is_absolute else "other")
        studio.write_text(config.serialize())
        result = converted(loaded(add(studio, tmp_path / "new", small_look).path), "film", "scene_linear", CODES)
        np.testing.assert_array_equal(result, converted(loaded(studio), "film", "scene_linear", CODES))

    def test_variables_that_a_config_does_not_declare_count_as_before(self, studio, small_look, tmp_path, monkeypatch):
        monkeypatch.setenv("SHOT", str(tmp_path))
        write_lut(tmp_path / "film.spi1d", THIRD_LUT)
        text = re.sub(r"environment:\n( .*\n)+", "", studio.read_text()).replace("$SHOW/luts", "luts")
        studio.write_text(text.replace("- luts", "- $SHOT", 1))
        result = loaded(add(studio, tmp_path / "new", small_look).path)
        assert_same(conversions(result), conversions(loaded(studio)))
        np.testing.assert_allclose(converted(result, "film", "scene_linear", CODES), THIRD_LUT.apply(CODES), atol=1e-6)

    @pytest.mark.parametrize("has_variable", [True, False])
    def test_a_plates_lut_stays_its_own_whatever_its_base_gets(
        self, studio, small_look, tmp_path, monkeypatch, has_variable
    ):
        """Else another LUT of the plate's name would change it: a later one, or that of another value of a variable."""
        if not has_variable:
            studio.write_text(studio.read_text().replace("$SHOW/", f"{tmp_path}/b/"))
        result = add(studio, tmp_path / "new", small_look).path
        (tmp_path / "b" / "luts").mkdir(parents=True)
        write_lut(tmp_path / "b" / "luts" / "plate01.spi1d", THIRD_LUT)
        monkeypatch.setenv("SHOW", str(tmp_path / "b"))
        light = converted(loaded(result), NAME, "lin_rec709_scene", CODES)
        np.testing.assert_allclose(light, LUT.apply(CODES), atol=1e-5)

    @pytest.mark.parametrize("path", ["luts", "../link/../luts"])
    def test_a_link_is_a_base_of_its_own(self, studio, small_look, tmp_path, path):
        """OpenColorIO looks for files next to it, and takes ".." out of names."""
        studio.write_text(studio.read_text().replace("- luts", f"- {path}"))
        for folder in (tmp_path / "show" / "luts", tmp_path / "luts"):
            folder.mkdir(parents=True)
            write_lut(folder / "film.spi1d", THIRD_LUT)
        (tmp_path / "link").symlink_to(studio.parent / "luts")
        (tmp_path / "show" / "config.ocio").symlink_to(studio)
        result = loaded(add(tmp_path / "show" / "config.ocio", tmp_path / "new", small_look).path)
        assert_same(conversions(result), conversions(loaded(tmp_path / "show" / "config.ocio")))
        with refused(ConfigError, "base_would_change"):
            add(tmp_path / "show" / "config.ocio", studio.parent, small_look)

    @pytest.mark.parametrize("name", ["film", "FILM"])
    def test_a_lut_of_the_bases_name_is_not_taken_for_it(self, studio, tmp_path, tolerance, name):
        """The plate's LUT would be called film.spi1d, like one of the base, for systems that compare without case."""
        studio.write_text(studio.read_text().replace("$SHOW/", ""))
        done = add(studio, tmp_path / "new", write_look(tmp_path / "look", [f"{name}.jpg"]))
        assert set(listed(tmp_path / "new")) == {"config.ocio", f"{name} ({lut_identity(LUT)[-8:]}).spi1d"}
        result = loaded(done.path)
        assert_same(conversions(result), conversions(loaded(studio)))
        light = converted(result, f"CRF {name}", "scene_linear", CODES)
        np.testing.assert_allclose(light, LUT.apply(CODES), atol=tolerance.plate)

    @pytest.mark.parametrize("name", ["plate01.spi1d", "sub/PLATE01.spi1d"])
    def test_a_lut_that_the_base_misses_is_not_found_in_a_plates(self, studio, small_look, tmp_path, name):
        studio.write_text(studio.read_text().replace("$SHOW/", "").replace("film.spi1d", name))
        own = f"plate01 ({lut_identity(LUT)[-8:]}).spi1d"
        assert listed(add(studio, tmp_path / "new", small_look).path.parent)[1] == own

    def test_a_config_of_profile_1_gets_the_space_alone(self, studio, small_look, tmp_path):
        config = OCIO.Config.CreateRaw()
        config.setVersion(1, 0)
        config.addColorSpace(OCIO.ColorSpace(name="lin_srgb"))
        config.setRole("scene_linear", "lin_srgb")
        studio.write_text(config.serialize())
        done = add(studio, tmp_path / "new", small_look)
        names = ("plate01_linear.exr", "plate01.jpg")
        assert (load_config(done.path).getMajorVersion(), done.without_rule) == (1, names)
        assert list(load_config(done.path).getColorSpaceNames())[-1] == NAME
        bright = write_look(tmp_path / "bright", exposure=1)
        assert refusal_of(ConfigError, add, studio, tmp_path / "other", bright).code == "exposure_in_version_1"

    @pytest.mark.parametrize("taken", [NAME, "crf_plate01"])
    @pytest.mark.parametrize("owner", ["hidden", "named transform", "alias of a named transform", "file rule"])
    def test_a_name_or_alias_that_something_else_has_is_not_taken(self, studio, small_look, tmp_path, owner, taken):
        config = loaded(studio)
        names = {"name": "curve", "aliases": [taken.upper()]} if "alias" in owner else {"name": taken}
        if owner == "hidden":
            config.setInactiveColorSpaces(f"film, {taken}")
        elif owner == "file rule":
            (rules := config.getFileRules()).insertRule(0, taken, "film", "other")
            config.setFileRules(rules)
        else:
            config.addNamedTransform(OCIO.NamedTransform(**names, forwardTransform=OCIO.MatrixTransform()))
        studio.write_text(config.serialize())
        name = f"{NAME} (look)" if taken == NAME else NAME
        assert [plate.name for plate in add(studio, tmp_path / "new", small_look).plates] == [name]
        assert name in loaded(tmp_path / "new" / "config.ocio").getColorSpaceNames()

    def test_one_that_is_not_valid_is_named(self, studio, small_look, tmp_path):
        studio.write_text(studio.read_text().replace("colorspace: sRGB", "colorspace: absent"))
        with refused(ConfigError, "config_refused", path=str(studio)):
            add(studio, tmp_path / "new", small_look)

    def test_hidden_plates_are_listed(self, studio, small_look, tmp_path):
        config = loaded(add(studio, tmp_path / "new", small_look).path)
        config.setInactiveColorSpaces(NAME)
        assert [plate.name for plate in plates_in_config(config)] == [NAME]

    def test_a_rule_may_give_a_named_transform(self, studio, small_look, tmp_path):
        config = loaded(studio)
        config.addNamedTransform(OCIO.NamedTransform(name="curve", forwardTransform=OCIO.RangeTransform(0, 1, 0, 1)))
        rules = config.getFileRules()
        rules.setDefaultRuleColorSpace("curve")
        config.setFileRules(rules)
        studio.write_text(config.serialize())
        result = loaded(add(studio, tmp_path / "new", small_look).path)
        assert [space_of(result, name) for name in ("plate01.jpg", "other.xyz")] == [NAME, "curve"]

    @pytest.mark.parametrize(("folder", "version"), [("a$b", 2), ("a:b", 1)])
    def test_a_folder_that_opencolorio_misreads_is_refused(self, studio, small_look, tmp_path, folder, version):
        if version == 1:
            views = "{d: [!<View> {name: v, colorspace: lin}]}"
            spaces = "[!<ColorSpace> {name: lin}]"
            studio.write_text(f"ocio_profile_version: 1\ndisplays: {views}\ncolorspaces: {spaces}\n")
        moved = studio.parent.rename(tmp_path / folder) / studio.name
        assert refusal_of(ConfigError, add, moved, tmp_path / "new", small_look).code == "base_folder_is_misread"


class TestAgain:
    def test_more_looks_are_added_to_the_config_of_the_first(self, studio, small_look, tmp_path, tolerance):
        one = add(studio, tmp_path / "one", small_look)
        two = add(one.path, tmp_path / "two", write_look(tmp_path / "night", ["night.jpg"], lut=OTHER_LUT))
        result = loaded(two.path)
        assert [plate.name for plate in two.plates] == ["CRF night"]
        for name, lut in ((NAME, LUT), ("CRF night", OTHER_LUT)):
            light = converted(result, name, "scene_linear", CODES)
            np.testing.assert_allclose(light, lut.apply(CODES), atol=tolerance.plate)
        assert [space_of(result, path) for path in ("plate01.jpg", "night.jpg")] == [NAME, "CRF night"]

    @pytest.mark.parametrize("is_together", [True, False])
    def test_plates_of_one_file_name_keep_their_responses_and_none_gets_the_rule(
        self, studio, tmp_path, tolerance, is_together
    ):
        luts = {"s010": LUT, "s020": OTHER_LUT, "s030": THIRD_LUT}
        looks = [write_look(tmp_path / shot, lut=lut) for shot, lut in luts.items()]
        if is_together:
            done = add(studio, tmp_path / "show", *looks)
        else:
            path = studio
            for number, look in enumerate(looks):
                done = add(path, tmp_path / f"show{number}", look)
                path = done.path
        result = loaded(done.path)
        for name, lut in zip((NAME, f"{NAME} (s020)", f"{NAME} (s030)"), luts.values(), strict=True):
            light = converted(result, name, "scene_linear", CODES)
            np.testing.assert_allclose(light, lut.apply(CODES), atol=tolerance.plate)
        assert space_of(result, "/s010/plate01.jpg") == space_of(loaded(studio), "plate01.jpg") == "sRGB"
        assert done.without_rule == ("plate01.jpg",)

    def test_the_same_again_writes_the_same_bytes(self, studio, small_look, tmp_path):
        add(studio, tmp_path / "new", small_look)
        before = tree(tmp_path / "new")
        add(studio, tmp_path / "new", small_look, overwrite=True)
        assert tree(tmp_path / "new") == before


class TestFolder:
    def test_that_of_the_base_is_refused(self, studio, small_look, tmp_path):
        (tmp_path / "link").symlink_to(studio.parent)
        for folder in (studio.parent, tmp_path / "link"):
            with refused(ConfigError, "base_would_change"):
                add(studio, folder, small_look, overwrite=True)

    @pytest.mark.parametrize("name", ["config.ocio", "plate01.spi1d"])
    def test_files_are_replaced_only_when_asked(self, small_look, tmp_path, name):
        (tmp_path / "show").mkdir()
        (tmp_path / "show" / name).write_text("mine")
        assert refusal_of(PlateError, add, STUDIO, tmp_path / "show", small_look).code == "file_exists"
        assert listed(tmp_path / "show") == [name]
        add(STUDIO, tmp_path / "show", small_look, overwrite=True)
        assert (tmp_path / "show" / name).read_text() != "mine"

    def test_a_failure_leaves_it_as_it_was(self, studio, small_look, monkeypatch, tmp_path):
        monkeypatch.setattr(derived, "write_config", Mock(side_effect=PlateError("the disk is full")))
        with pytest.raises(PlateError):
            add(studio, tmp_path / "new" / "show", small_look)
        assert not (tmp_path / "new").exists()

    def test_it_can_be_moved_if_the_base_is_built_in(self, small_look, tmp_path, tolerance):
        add(STUDIO, tmp_path / "show", small_look)
        (tmp_path / "show").rename(tmp_path / "elsewhere")
        result = converted(loaded(tmp_path / "elsewhere" / "config.ocio"), NAME, "lin_rec709_scene", CODES)
        np.testing.assert_allclose(result, LUT.apply(CODES), atol=tolerance.plate)

"""Which files get a plate's space in somebody's config; and what of a look is known."""

import json

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.portable import portable_config
from crfnet.configs.studio.looks import read_looks
from crfnet.defaults import ESTIMATES
from crfnet.errors import ConfigError, LutError
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import Lut1D
from crfnet.luts.rgb_lut import RgbLut1D
from crfnet_core.colorimetry import DISPLAY_P3, REC709, Primaries
from tests.helpers.configs import loaded, rule_names
from tests.helpers.looks import LUT, NAME, OTHER_LUT, STUDIO, add, space_of, write_look


class TestRules:
    def test_a_cameras_own_name_gets_no_rule(self, tmp_path):
        small_look = write_look(tmp_path / "look", ["IMG_0042.JPG"])
        done = add(STUDIO, small_look, tmp_path / "show.ocio")
        assert space_of(loaded(done.config), "IMG_0042.JPG") == "sRGB - Display"
        assert space_of(loaded(done.config), "img_0042_linear.exr") == "Linear Rec.709 (sRGB)"
        assert done.notes == ("no file rule for IMG_0042.JPG: many cameras give such names; --rule PATTERN makes one",)

    def test_a_rule_that_is_asked_for_is_made(self, tmp_path):
        small_look = write_look(tmp_path / "look", ["IMG_0042.JPG"])
        done = add(
            STUDIO, small_look, tmp_path / "a.ocio", patterns=("s010/*.jpg",), linear_patterns=("s010/lin.#.exr",)
        )
        found = loaded(done.config)
        paths = ("/x/s010/IMG_0042.JPG", "/x/s020/IMG_0042.JPG", "/x/s010/lin.0001.exr", "/x/s010/IMG_0042_linear.exr")
        expected = ["CRF IMG_0042", "sRGB - Display", "Linear Rec.709 (sRGB)", "ACES2065-1"]
        assert [space_of(found, path) for path in paths] == expected
        assert done.notes == ()

    def test_no_rules_at_all(self, small_look, tmp_path):
        done = add(STUDIO, small_look, tmp_path / "show.ocio", has_rules=False)
        assert rule_names(loaded(done.config)) == rule_names(OCIO.Config.CreateFromBuiltinConfig(STUDIO))

    def test_every_photograph_and_every_frame_has_the_response(self, tmp_path):
        small_look = write_look(tmp_path / "look", ["sky.0001.png", "wall.png"])
        found = loaded(add(STUDIO, small_look, tmp_path / "show.ocio").config)
        assert {space_of(found, path) for path in ("sky.0099.png", "a/WALL.png")} == {"CRF sky.0001"}
        assert space_of(found, "sky.v2.png") == "sRGB - Display"
        for path in ("sky.0099_linear.exr", "wall_linear.exr"):
            assert space_of(found, path) == "Linear Rec.709 (sRGB)"

    @pytest.mark.parametrize(
        ("interop_id", "space"),
        [
            ("lin_ap1_scene", "ACEScg"),
            ("lin_ap0_scene", "ACES2065-1"),
            ("", "ACES2065-1"),
            ("unheard_of", "ACES2065-1"),
        ],
    )
    def test_linear_plates_have_the_space_of_their_headers(self, tmp_path, interop_id, space):
        """Without one, or with an unknown one, nothing is guessed: the studio's own rule stays."""
        small_look = write_look(tmp_path / "look", interop_id=interop_id)
        done = add(STUDIO, small_look, tmp_path / "show.ocio")
        assert space_of(loaded(done.config), "plate01_linear.exr") == space
        assert bool(done.notes) == (interop_id in ("", "unheard_of"))

    def test_a_blenders_config_gets_none_unless_asked(self, small_look, tmp_path):
        folder = tmp_path / "5.2" / "datafiles" / "colormanagement"
        folder.mkdir(parents=True)
        (folder / "config.ocio").write_text(portable_config([]).serialize())
        done = add(folder, small_look)
        assert rule_names(loaded(done.config)) == rule_names(portable_config([]))
        assert "Blender's config is that of all projects" in done.notes[0]
        assert NAME in rule_names(loaded(add(folder, small_look, patterns=("plate01.jpg",)).config))


class TestLooks:
    def test_folder_document_and_lut_are_one_look(self, tmp_path):
        folder = write_look(tmp_path / "look", exposure=1.5)
        looks = [*read_looks(folder), *read_looks(folder / "plate01.json"), *read_looks(folder / "plate01.spi1d")]
        assert {small_look.source for small_look in looks} == {folder / "plate01"}
        assert {small_look.space.exposure for small_look in looks} == {1.5}
        assert all(small_look.photographs == ("plate01.jpg",) for small_look in looks)
        assert all(small_look.linear == {"plate01_linear.exr": "lin_rec709_scene"} for small_look in looks)

    def test_primaries_are_those_of_the_document(self, tmp_path):
        wide = Primaries("my camera", (0.7, 0.3), (0.2, 0.7), (0.1, 0.05))
        for primaries in (DISPLAY_P3, REC709, wide):
            (found,) = read_looks(write_look(tmp_path / "look", primaries=primaries))
            assert found.space.primaries == primaries

    def test_the_exposure_may_be_edited_in_the_looks_config(self, tmp_path):
        folder = write_look(tmp_path / "look", exposure=1.5)
        text = (folder / "config.ocio").read_text()
        (folder / "config.ocio").write_text(text.replace("exposure: 1.5", "exposure: -2"))
        assert read_looks(folder)[0].space.exposure == -2
        (folder / "config.ocio").unlink()
        assert read_looks(folder)[0].space.exposure == 1.5

    def test_many_estimates_have_folders_of_their_own(self, tmp_path):
        write_look(tmp_path / "all" / "a", ["a.jpg"])
        write_look(tmp_path / "all" / "b", ["b.jpg"])
        with pytest.raises(ConfigError, match="holds nothing that crfnet estimate wrote"):
            read_looks(tmp_path / "all")
        (tmp_path / "all" / ESTIMATES).write_text("")
        assert [each.space.name for each in read_looks(tmp_path / "all")] == ["CRF a", "CRF b"]

    @pytest.mark.parametrize("suffix", [".cube", ".clf", ".spi1d"])
    def test_a_lut_from_elsewhere_will_do(self, tmp_path, suffix):
        write_lut(tmp_path / f"cam{suffix}", LUT)
        (small_look,) = read_looks(tmp_path / f"cam{suffix}")
        assert (small_look.space.name, small_look.space.exposure, small_look.photographs, small_look.linear) == (
            "CRF cam",
            0,
            (),
            {},
        )
        assert small_look.lut == LUT

    @pytest.mark.parametrize(
        ("name", "content", "message"),
        [
            ("empty", None, "holds nothing that crfnet estimate wrote; give its folder, JSON or LUT"),
            ("a.json", "{}", "is no document of crfnet estimate; give its folder, JSON or LUT"),
            ("a.json", "no json", "is no document of crfnet estimate"),
            ("a.jpg", "", "is no document of crfnet estimate"),
        ],
    )
    def test_anything_else_is_refused(self, tmp_path, name, content, message):
        path = tmp_path / name
        path.mkdir() if content is None else path.write_text(content)
        with pytest.raises(ConfigError, match=message):
            read_looks(path)

    def test_a_document_does_not_lead_out_of_its_folder(self, tmp_path):
        folder = write_look(tmp_path / "look")
        document = json.loads((folder / "plate01.json").read_text())
        document["files"]["spi1d"] = "../secret.spi1d"
        (folder / "plate01.json").write_text(json.dumps(document))
        with pytest.raises(ConfigError, match="holds nothing that crfnet estimate wrote"):
            read_looks(folder)

    def test_a_missing_lut_is_named(self, tmp_path):
        folder = write_look(tmp_path / "look")
        (folder / "plate01.spi1d").unlink()
        with pytest.raises(LutError, match=r"plate01\.spi1d: cannot be read"):
            read_looks(folder)

    def test_a_lut_of_another_kind_is_refused(self, tmp_path):
        """One that leads from light to codes, and one whose channels differ."""
        write_lut(tmp_path / "forward.spi1d", Lut1D(np.linspace(0, 1, 256) ** 0.45))
        with pytest.raises(LutError, match=r"forward\.spi1d: the LUT brightens, .* give its inverse"):
            read_looks(tmp_path / "forward.spi1d")
        write_lut(tmp_path / "rgb.cube", RgbLut1D((LUT, LUT, OTHER_LUT)))
        with pytest.raises(LutError, match=r"rgb\.cube: the LUT treats R, G and B apart"):
            read_looks(tmp_path / "rgb.cube")

import itertools
import struct

import numpy as np
import pytest
from PIL import Image

from crfnet_core.colorimetry import (
    ADOBE_RGB,
    AP0,
    AP1,
    D50,
    DISPLAY_P3,
    PHOTOGRAPHIC,
    PROPHOTO,
    REC709,
    REC2020,
    conversion_matrix,
    xyz_of,
)
from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.metadata.color_tags import PRIMARIES, ColorTags, cicp_tags
from crfnet_core.photograph.metadata.header_colors import header_color_tags
from crfnet_core.photograph.metadata.icc import DAMAGED, OTHER_COLORS, TABLES, read_icc
from crfnet_core.photograph.metadata.jpeg import read_jpeg_header
from tests.helpers.color_profiles import (
    OWN,
    exif_segment,
    matrix_profile,
    named,
    numbers,
    profile,
    sampled_curve,
    write_tagged,
)
from tests.helpers.crafted_files import bmp, with_jpeg_segment
from tests.helpers.folders import written
from tests.helpers.images import write_image

colour = pytest.importorskip("colour")

#: colour-science's names.
NAMES = {"sRGB": REC709, "Display P3": DISPLAY_P3, "Adobe RGB (1998)": ADOBE_RGB, "ProPhoto RGB": PROPHOTO}
NAMES |= {"ITU-R BT.2020": REC2020, "ACES2065-1": AP0, "ACEScg": AP1}

GRAY = np.full((16, 16, 3), 128, np.uint8)


def corners(primaries):
    return primaries.corners.ravel().tolist()


class TestMatrices:
    @pytest.mark.parametrize("name", NAMES)
    def test_chromaticities_are_those_of_colour_science(self, name):
        space = colour.RGB_COLOURSPACES[name]
        expected = [*np.ravel(space.primaries), *space.whitepoint]
        np.testing.assert_allclose(corners(NAMES[name]), expected, atol=1e-4)

    @pytest.mark.parametrize(("source", "target"), [*itertools.pairwise([*NAMES, "sRGB"])])
    def test_conversions_are_those_of_colour_science(self, source, target):
        spaces = [colour.RGB_COLOURSPACES[name].copy() for name in (source, target)]
        for space, name in zip(spaces, (source, target), strict=True):
            # Their own chromaticities of ProPhoto have four digits, so ours go in.
            space.primaries, space.whitepoint = np.reshape(corners(NAMES[name])[:6], (3, 2)), NAMES[name].white
            space.use_derived_transformation_matrices(True)
        expected = colour.matrix_RGB_to_RGB(*spaces, chromatic_adaptation_transform="Bradford")
        np.testing.assert_allclose(conversion_matrix(NAMES[source], NAMES[target]), expected, atol=1e-9)


class TestIccProfiles:
    @pytest.mark.parametrize("version", [2, 4])
    @pytest.mark.parametrize("chad", [True, False])
    @pytest.mark.parametrize("named", [*PHOTOGRAPHIC.values(), AP1], ids=lambda named: named.name)
    def test_named_primaries_are_known_by_their_matrix(self, named, version, chad):
        assert read_icc(matrix_profile(named, version=version, states_adaptation=chad)).primaries is named

    def test_a_name_that_is_not_ascii_is_no_damage(self):
        name = b"desc" + struct.pack(">4xI", 6) + "Écran".encode("latin-1") + bytes(79)
        assert read_icc(matrix_profile(DISPLAY_P3, version=2, desc=name)).primaries is DISPLAY_P3

    def test_rounding_does_not_hide_them(self):
        # The colorants of the sRGB profile of 1998, rounded to four digits.
        columns = ((0.4361, 0.2225, 0.0139), (0.3851, 0.7169, 0.0971), (0.1431, 0.0606, 0.7141))
        tags = {f"{name}XYZ": numbers(b"XYZ ", xyz) for name, xyz in zip("rgb", columns, strict=True)}
        assert read_icc(matrix_profile(REC709, version=2, **tags)).primaries is REC709

    @pytest.mark.parametrize(("version", "chad"), [(2, False), (2, True), (4, True)])
    def test_others_are_found_under_their_own_white(self, version, chad):
        unnamed = read_icc(matrix_profile(OWN, version=version, states_adaptation=chad)).primaries
        np.testing.assert_allclose(corners(unnamed), corners(OWN), atol=2e-4)
        assert (unnamed.name, unnamed.interop_id) == ("primaries of its own", "")

    def test_without_a_word_on_adaptation_the_white_is_d50(self):
        unnamed = read_icc(matrix_profile(OWN, version=4, states_adaptation=False)).primaries
        assert unnamed.white == pytest.approx(D50, abs=2e-4)

    @pytest.mark.parametrize(
        "icc",
        [
            matrix_profile(DISPLAY_P3, A2B0=b"mft2".ljust(52, b"\0")),
            profile({"A2B0": b"mft2".ljust(52, b"\0")}, pcs=b"Lab "),
            profile({}),
            profile({"rXYZ": b"XYZ ", "gXYZ": b"", "bXYZ": bytes(20)}),
            profile({name: numbers(b"XYZ ", (0.3214, 0.3333, 0.275)) for name in ("rXYZ", "gXYZ", "bXYZ")}),
            matrix_profile(REC709, **{f"{'rgb'[k]}XYZ": numbers(b"XYZ ", np.eye(3)[k] / 2) for k in range(3)}),
            matrix_profile(OWN, chad=numbers(b"sf32", np.zeros(9))),
            matrix_profile(OWN, chad=numbers(b"sf32", np.diag([1, -4, 1]))),
        ],
        ids=["tables too", "tables", "empty", "short", "three equal", "not white", "no adaptation", "no white"],
    )
    def test_what_gives_no_primaries_is_unknown(self, icc):
        assert read_icc(icc).primaries is None

    @pytest.mark.parametrize(
        ("icc", "source"),
        [(b"", ""), (bytes(200), DAMAGED), (b"acsp", DAMAGED), (profile({}, color=b"CMYK"), OTHER_COLORS)],
    )
    def test_profiles_of_other_colors_and_other_bytes_say_no_primaries(self, icc, source):
        assert read_icc(icc) == ColorTags(source=source)

    def test_damage_anywhere_in_a_profile_is_no_error(self):
        rng = np.random.default_rng(0)
        whole = np.frombuffer(matrix_profile(DISPLAY_P3), np.uint8)
        for _ in range(200):
            damaged = whole.copy()
            damaged[rng.integers(0, len(whole), 4)] = rng.integers(0, 256, 4)
            read_icc(damaged.tobytes())
            read_icc(damaged.tobytes()[: rng.integers(0, len(whole))])

    @pytest.mark.parametrize("version", [2, 4])
    @pytest.mark.parametrize(
        ("curve", "transfer"),
        [
            (b"curv" + bytes(8), "linear"),
            (b"curv" + struct.pack(">IIH", 0, 1, 256), "linear"),
            (b"curv" + struct.pack(">II2H", 0, 2, 0, 65535), "linear"),
            (b"curv" + struct.pack(">II2H", 0, 2, 2000, 65535), "linear"),  # a lifted black
            (b"curv" + struct.pack(">II2H", 0, 2, 65535, 65535), ""),  # no range
            (b"curv" + struct.pack(">II2H", 0, 2, 65535, 0), "a negative"),
            (b"curv" + struct.pack(">IIH", 0, 1, round(1.1 * 256)), "nearly linear"),
            (b"para" + struct.pack(">IHHi", 0, 0, 0, 65536), "linear"),
            (b"para" + struct.pack(">IHHi", 0, 0, 0, round(1.8 * 65536)), ""),
        ],
    )
    def test_linear_and_falling_curves_are_seen(self, version, curve, transfer):
        assert read_icc(matrix_profile(REC2020, version=version, curves=[curve] * 3)).transfer == transfer

    @pytest.mark.parametrize(
        ("light", "transfer"),
        [
            (lambda codes: colour.models.eotf_ST2084(codes) / 10_000, "PQ"),
            (lambda codes: colour.models.eotf_ST2084(codes) / 203, "PQ"),
            (colour.models.oetf_inverse_BT2100_HLG, "HLG"),
            (lambda codes: colour.models.oetf_inverse_BT2100_HLG(codes) ** 1.2, "HLG"),
            (lambda codes: colour.models.log_decoding_SLog3(codes) / 38, "log"),  # or D-Log
            (lambda codes: colour.models.log_decoding_ARRILogC4(codes) / 469, "ARRI LogC4"),
            (lambda codes: codes**2.6, ""),
            (colour.models.oetf_inverse_BT709, ""),
        ],
    )
    def test_published_curves_are_seen_whatever_the_profile_is_called(self, light, transfer):
        curve = sampled_curve(light)
        for name in ("Epson PQ-3 paper", "Hlg-Scan", "sRGB"):
            gray = profile({"kTRC": curve, "wtpt": numbers(b"XYZ ", xyz_of(D50)), **named(name)}, color=b"GRAY")
            color = matrix_profile(REC2020, curves=[curve] * 3, **named(name))
            assert [read_icc(icc).transfer for icc in (gray, color)] == [transfer] * 2

    @pytest.mark.parametrize(
        ("decode", "name", "transfer"),
        [("SLog3", "S-Log3 S-Gamut3", "Sony S-Log3"), ("Cineon", "Cineon", "Cineon log"), ("Cineon", "sRGB", "log")],
    )
    def test_the_name_says_which_log_curve_it_is(self, decode, name, transfer):
        light = getattr(colour.models, f"log_decoding_{decode}")
        curve = sampled_curve(lambda codes: light(codes) / light(1.0))
        assert read_icc(matrix_profile(REC2020, curves=[curve] * 3, **named(name))).transfer == transfer

    def test_curves_that_differ_by_channel_are_named(self):
        for gammas, are_equal in [((2.2, 2.2, 2.25), True), ((2.2, 1, 2.2), False), ((2.2, 2.2, 2.4), False)]:
            curves = [sampled_curve(lambda codes, gamma=gamma: codes**gamma) for gamma in gammas]
            transfer = read_icc(matrix_profile(REC2020, curves=curves)).transfer
            assert transfer == ("" if are_equal else "three channels of different curves")


class TestFiles:
    @staticmethod
    def tags(path):
        return read_photo(path).metadata.color

    @pytest.mark.parametrize("name", ["a.jpg", "a.png", "a.tif", "a.webp"])
    def test_an_icc_profile_is_read(self, tmp_path, name):
        path = write_tagged(tmp_path / name, GRAY, matrix_profile(DISPLAY_P3))
        assert self.tags(path) == ColorTags(DISPLAY_P3, "", "ICC profile", "ICC profile")

    def test_the_profile_of_a_bmp_is_read(self, tmp_path):
        icc = matrix_profile(DISPLAY_P3)
        fields = bytes(16) + b"DEBM" + bytes(52) + struct.pack("<III", 140, len(icc), 0)
        path = written(tmp_path / "a.bmp", bmp(2, 2, bytes(16), size=124, fields=fields) + icc)
        assert self.tags(path) == ColorTags(DISPLAY_P3, "", "ICC profile", "ICC profile")

    def test_a_profile_of_tables_is_unknown_whatever_exif_says(self, tmp_path):
        icc = profile({"A2B0": b"mft2".ljust(52, b"\0")})
        assert self.tags(write_tagged(tmp_path / "a.jpg", GRAY, icc, Exif__ColorSpace=1)).source == TABLES

    def test_a_profile_of_which_a_segment_is_absent_is_damaged(self, tmp_path):
        path = write_image(tmp_path / "a.jpg", GRAY)
        content = with_jpeg_segment(path.read_bytes(), 0xE2, b"ICC_PROFILE\0\1\2" + matrix_profile(DISPLAY_P3))
        assert self.tags(written(path, content)) == ColorTags(source=DAMAGED)

    @pytest.mark.parametrize(("space", "primaries"), [(1, REC709), (2, ADOBE_RGB), (65535, None)])
    def test_exif_is_read(self, tmp_path, space, primaries):
        expected = ColorTags(primaries, source="EXIF" if primaries else "")
        assert self.tags(write_image(tmp_path / "a.jpg", GRAY, Exif__ColorSpace=space)) == expected

    @pytest.mark.parametrize(("index", "primaries"), [("R03", ADOBE_RGB), ("R98", REC709), ("THM", None)])
    @pytest.mark.parametrize("suffix", ["jpg", "png", "webp", "tif"])
    def test_the_interoperability_index_of_dcf_is_read(self, tmp_path, index, primaries, suffix):
        tags = {"tiffinfo": {34665: {40965: {1: index}}}} if suffix == "tif" else {"exif": exif_segment(index)}
        Image.fromarray(GRAY).save(path := tmp_path / f"a.{suffix}", **tags)
        assert self.tags(path).primaries == primaries

    def test_damaged_exif_has_no_tags(self, tmp_path):
        whole, content = exif_segment("R03"), write_image(tmp_path / "a.jpg", GRAY).read_bytes()
        for length in range(0, len(whole) - 8, 3):
            header = read_jpeg_header(with_jpeg_segment(content, 0xE1, whole[:length]))
            assert (header.interop_index, header.has_jfif) == ("", True)

    def test_a_gray_profile_of_a_jpeg_is_not_damaged(self, tmp_path):
        gray = profile(
            {"kTRC": sampled_curve(lambda codes: codes**2.2), "wtpt": numbers(b"XYZ ", xyz_of(D50))}, color=b"GRAY"
        )
        Image.fromarray(GRAY[..., 0]).save(tmp_path / "a.jpg", icc_profile=gray)
        assert (self.tags(tmp_path / "a.jpg").source, read_icc(gray).transfer_source) == ("", "ICC profile")

    def test_a_profile_may_hold_cicp(self, tmp_path):
        icc = matrix_profile(REC2020, cicp=b"cicp" + bytes(4) + bytes([9, 16, 0, 1]))
        found = self.tags(write_tagged(tmp_path / "a.jpg", GRAY, icc))
        assert found == ColorTags(REC2020, "PQ", "ICC profile", "ICC profile")


class TestOpenExr:
    @staticmethod
    def tags(**attributes):
        import OpenImageIO as oiio

        header = oiio.ImageSpec(8, 8, 3, "half")
        for name, value in attributes.items():
            header.attribute(name, *((oiio.TypeDesc("float[8]"), value) if isinstance(value, list) else (value,)))
        return header_color_tags(header, "OpenEXR")

    @pytest.mark.parametrize(
        ("name", "primaries", "source"),
        [
            ("srgb_p3d65_scene", DISPLAY_P3, "colorInteropID"),
            ("g22_adobergb_scene", ADOBE_RGB, "colorInteropID"),
            ("g26_xyzd65_display", None, "colorInteropID"),
            *((name, None, "") for name in ("unknown", "data")),
        ],
    )
    def test_interop_names_are_read(self, name, primaries, source):
        found = self.tags(colorInteropID=name)
        assert (found.primaries, found.source) == (primaries, source)

    @pytest.mark.parametrize("primaries", [*PHOTOGRAPHIC.values(), AP0, AP1])
    def test_named_chromaticities_are_known(self, primaries):
        assert self.tags(chromaticities=primaries.corners.ravel().tolist()).primaries is primaries

    def test_others_are_taken_as_they_are(self):
        tags = self.tags(chromaticities=OWN.corners.ravel().tolist())
        np.testing.assert_allclose(tags.primaries.corners, OWN.corners, atol=1e-6)
        assert tags.source == "chromaticities"

    @pytest.mark.parametrize("numbers", [[0.0] * 8, [0.3] * 8, [np.nan] * 8, [0.6, 0.3, 0.6, 0.3, 0.6, 0.3, 0.3, 0.3]])
    def test_no_triangle_says_nothing(self, numbers):
        assert self.tags(chromaticities=numbers) == ColorTags()


@pytest.mark.parametrize("code", PRIMARIES)
def test_cicp_primaries_make_a_white(code):
    primaries = PRIMARIES[code]
    np.testing.assert_allclose(primaries.to_xyz().sum(axis=1), xyz_of(primaries.white), atol=1e-12)
    assert cicp_tags((code, 1)) == ColorTags(primaries, "", "CICP", "CICP")


@pytest.mark.parametrize("codes", [(), (1,), (2, 2), (0, 0), (3, 3, 0, 0)])
def test_codes_that_are_unspecified_say_nothing(codes):
    assert cicp_tags(codes) == ColorTags()


def test_cicp_primaries_of_no_camera_are_unknown_and_named():
    assert cicp_tags((10, 17)) == ColorTags(None, "SMPTE ST 428-1", "CICP primaries 10", "CICP")

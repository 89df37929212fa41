"""Hugin's five parameters, judged by nona and pto_var where they are installed."""

import numpy as np
import pytest

from crfnet.errors import LutError
from crfnet.interchange.files import read_response, write_response
from crfnet.interchange.hugin import hugin_parameters, hugin_response
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.images import read_image, write_image

#: Measured, not calibrated, and so steep that Hugin levels it off.
PARAMETERS = [(0, 0, 0, 0, 0), (1.5, -0.7, 0.3, 0.2, -0.1), (-3.1, -0.46, 0.13, 0.13, 0.11), (-8, 4, -2, 1, 1)]

IMAGE = (
    "i w2048 h64 f0 v50 {} Eev0 Er1 Eb1 r0 p0 y0 TrX0 TrY0 TrZ0 Tpy0 Tpp0 j0 a0 b0 c0 d0 e0 g0 t0"
    ' Va1 Vb0 Vc0 Vd0 Vx0 Vy0  Vm5 n"{}"'
)


def project(path, *images, name="ramp.tif"):
    """A Hugin project with an image for each tuple of parameters."""
    head = '# hugin project file\np f0 w2048 h64 v50  k0 E0 R1 n"TIFF_m c:NONE"\nm i0\n'
    lines = [
        IMAGE.format(" ".join(f"R{key}{value}" for key, value in zip("abcde", image, strict=True)), name)
        for image in images
    ]
    path.write_text("\n".join([head, *lines, "v Ra0", "v", ""]))
    return path


@pytest.mark.parametrize("parameters", PARAMETERS)
def test_nona_applies_the_response_that_is_read(tmp_path, tool, parameters):
    codes = np.linspace(0, 65535, 2048).round().astype(np.uint16)
    write_image(tmp_path / "ramp.tif", np.broadcast_to(codes[None, :, None], (64, 2048, 3)))
    path = project(tmp_path / "a.pto", parameters)
    tool("nona", "-r", "hdr", "-m", "TIFF_m", "-o", "linear", path)
    expected = read_image(tmp_path / "linear0000.tif")[32, :, 0]
    error = np.abs(read_response(path).lut.apply(codes / 65535) - expected)
    assert error[2:-2].max() < 3e-3  # a response that was levelled off jumps next to both ends
    assert np.sqrt(np.mean(error[2:-2] ** 2)) < 1e-3


def test_nona_applies_the_response_that_is_written(tmp_path, tool, true_response):
    codes = np.linspace(0, 65535, 2048).round().astype(np.uint16)
    write_image(tmp_path / "ramp.tif", np.broadcast_to(codes[None, :, None], (64, 2048, 3)))
    path = project(tmp_path / "a.pto", PARAMETERS[0])
    said = write_response(path, inverse_response_lut(true_response), overwrite=True)
    tool("nona", "-r", "hdr", "-m", "TIFF_m", "-o", "linear", path)
    linear = read_image(tmp_path / "linear0000.tif")[32, :, 0]
    written = ResponseCurve.from_samples(hugin_response(hugin_parameters(true_response.brightness)))
    assert np.abs(linear - written.inverse(codes / 65535)).max() < 3e-3
    error = 100 * np.sqrt(
        np.mean((hugin_response(hugin_parameters(true_response.brightness)) - true_response.brightness) ** 2)
    )
    assert said.endswith(f"off by {error:.2g} % of the brightness range (RMS)")
    assert error < 1


def test_hugin_reads_the_project_that_is_written(tmp_path, tool, true_response):
    path = project(tmp_path / "a.pto", PARAMETERS[0], PARAMETERS[0])
    write_response(path, inverse_response_lut(true_response), overwrite=True)
    tool("pto_var", "--set", "y=1", "-o", "b.pto", path)
    assert read_response(tmp_path / "b.pto").lut.values == pytest.approx(read_response(path).lut.values, abs=1e-6)


@pytest.mark.parametrize("parameters", PARAMETERS[:3])
def test_the_parameters_of_a_response_are_found_again(parameters):
    assert hugin_parameters(hugin_response(np.array(parameters))) == pytest.approx(parameters, abs=0.02)


def test_uncalibrated_images_are_said_to_be_so(tmp_path):
    found = read_response(project(tmp_path / "a.pto", PARAMETERS[0]))
    assert found.notes == (
        "Ra 0 Rb 0 Rc 0 Rd 0 Re 0: Hugin's default, the mean of many cameras, so nothing was measured",
    )
    assert found.words == "Hugin's EMoR parameters, one table, from light to code values"


def test_links_between_images_are_followed_and_kept(tmp_path, true_response):
    links = ("=0",) * 5
    path = project(tmp_path / "a.pto", PARAMETERS[1], links)
    assert read_response(path).lut == read_response(path, curve="0").lut == read_response(path, curve="1").lut
    write_response(path, inverse_response_lut(true_response), overwrite=True)
    assert path.read_text().count("Ra=0 Rb=0 Rc=0 Rd=0 Re=0") == 1


def test_nothing_but_the_response_is_changed(tmp_path, true_response):
    path = project(tmp_path / "a.pto", PARAMETERS[0], name="a Ra1 b.jpg")
    before = path.read_text().splitlines()
    write_response(path, inverse_response_lut(true_response), overwrite=True)
    after = path.read_text().splitlines()
    changed = [(old, new) for old, new in zip(before, after, strict=True) if old != new]
    assert len(changed) == 1
    old, new = (set(line.split()) for line in changed[0])
    assert (
        sorted(word[:2] for word in old - new)
        == sorted(word[:2] for word in new - old)
        == ["Ra", "Rb", "Rc", "Rd", "Re"]
    )
    assert changed[0][1].endswith('n"a Ra1 b.jpg"')


@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
def test_names_in_any_encoding_and_line_ends_stay_byte_for_byte(tmp_path, true_response, end):
    path = project(tmp_path / "a.pto", PARAMETERS[0], name="K_che/IMG_1.jpg")
    before = path.read_bytes().replace(b"K_che", b"K\xfc\x85che").replace(b"\n", end)
    path.write_bytes(before)
    write_response(path, inverse_response_lut(true_response), overwrite=True)
    after = path.read_bytes()
    old, new = (content.split(b"\n") for content in (before, after))
    (place,) = [place for place, (was, now) in enumerate(zip(old, new, strict=True)) if was != now]
    assert new[place].startswith(b"i w2048 h64")
    assert old[place].partition(b' n"')[2] == new[place].partition(b' n"')[2]
    assert after.count(b"\r") == before.count(b"\r")


@pytest.mark.parametrize("link", ["=1.2.3", "=-1", "=7", "=1", "=1e0"])
def test_a_link_that_leads_nowhere_is_one_clear_line(tmp_path, true_response, link):
    path = project(tmp_path / "a.pto", PARAMETERS[1], (link, "=0", "=0", "=0", "=0"))
    with pytest.raises(LutError, match=f"a.pto: image 1 takes Ra from image {link[1:]}, which has none of its own"):
        read_response(path)
    with pytest.raises(LutError, match="save the project again in Hugin"):
        write_response(path, inverse_response_lut(true_response), overwrite=True)


def test_different_images_need_a_choice(tmp_path):
    path = project(tmp_path / "a.pto", *PARAMETERS[:2])
    with pytest.raises(LutError, match="images 0 and 1 have different responses; choose with crfnet convert --curve 1"):
        read_response(path)
    assert read_response(path, curve="1").notes == ("Ra 1.5 Rb -0.7 Rc 0.3 Rd 0.2 Re -0.1",)
    with pytest.raises(LutError, match="has no image '2'; name one of 0 to 1"):
        read_response(path, curve="2")


def test_what_cannot_be_written_is_refused(tmp_path, true_response, rgb_lut):
    lut = inverse_response_lut(true_response)
    with pytest.raises(LutError, match="there is no such project; save one in Hugin first"):
        write_response(tmp_path / "none.pto", lut)
    path = project(tmp_path / "a.pto", PARAMETERS[0])
    before = path.read_bytes()
    with pytest.raises(LutError, match="exists already"):
        write_response(path, lut)
    with pytest.raises(LutError, match="Hugin has one response for R, G and B"):
        write_response(path, rgb_lut, overwrite=True)
    assert path.read_bytes() == before
    (tmp_path / "b.pto").write_text("p f0\n")
    with pytest.raises(LutError, match="has no images with Ra to Re"):
        write_response(tmp_path / "b.pto", lut, overwrite=True)

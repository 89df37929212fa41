"""The response files of pfstools, judged by pfshdrcalibrate where it is installed."""

import numpy as np
import pytest

from crfnet.errors import LutError
from crfnet.interchange.files import read_response, write_response

#: From linear sRGB to XYZ (IEC 61966-2-1), in which PFS streams are.
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def pfs_pixels(stream):
    """The pixels of a PFS stream as linear sRGB, shape (H, W, 3)."""
    header, _, data = stream.partition(b"ENDH")
    width, height = map(int, header.split()[1:3])
    count = 3 * width * height
    xyz = np.frombuffer(data[: 4 * count], dtype="<f4").reshape(3, height, width)
    return np.einsum("ij,jhw->hwi", np.linalg.inv(TO_XYZ), xyz)


@pytest.fixture
def frames(series, tool, tmp_path):
    """The exposure series as a PFS stream."""
    lines = [f"{path} {1 / time} 4 100 0\n" for path, time in series.items()]
    (tmp_path / "series.hdrgen").write_text("".join(lines))
    return tool("pfsinhdrgen", "series.hdrgen")


def test_what_is_written_is_read_back(tmp_path, rgb_lut):
    write_response(tmp_path / "a.m", rgb_lut)
    found = read_response(tmp_path / "a.m")
    assert found.words == "pfstools response, R, G and B apart, from code values to light"
    codes = np.linspace(0, 1, 256)[1:]
    for channel, expected in zip(found.lut.channels, rgb_lut.channels, strict=True):
        assert np.abs(channel.apply(codes) - expected.apply(codes)).max() < 1e-6


def test_what_pfshdrcalibrate_saves_is_read(tmp_path, frames, tool, curves):
    tool("pfshdrcalibrate", "-s", "saved.m", "-c", "robertson", stdin=frames)
    found = read_response(tmp_path / "saved.m").lut
    codes = np.arange(20, 250) / 255
    for channel, curve in zip(found.channels, curves, strict=True):
        shape = channel.apply(codes) / channel.apply(np.array([128 / 255]))
        assert np.abs(np.log2(shape / (curve.inverse(codes) / curve.inverse(128 / 255)))).max() < 0.3  # stops


def test_pfshdrcalibrate_merges_with_what_is_written(tmp_path, frames, tool, light, rgb_lut):
    write_response(tmp_path / "a.m", rgb_lut)
    merged = pfs_pixels(tool("pfshdrcalibrate", "-f", "a.m", stdin=frames))
    ratio = np.log2(merged / light)
    lit = (light > 0.01).all(axis=2)  # where a code is a small part of a stop in the longest exposure
    assert np.abs(ratio[lit] - np.median(ratio[lit])).max() < 0.1  # stops, and one scale for all channels


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: text.replace("# name: IG", "# name: XX"), "holds no matrices IR, IG and IB"),
        (lambda text: text.replace("# rows: 256", "# rows: 255", 1), "holds 256 codes and announces 255"),
        (lambda text: "\n".join(text.splitlines()[:200]), "holds no matrices IR, IG and IB"),
        (lambda text: text.replace(" 100 ", " 1OO ", 1), "'1OO' is no number"),
    ],
)
def test_damaged_files_are_refused(tmp_path, rgb_lut, change, message):
    write_response(tmp_path / "a.m", rgb_lut)
    (tmp_path / "b.m").write_text(change((tmp_path / "a.m").read_text()))
    with pytest.raises(LutError, match=message):
        read_response(tmp_path / "b.m")

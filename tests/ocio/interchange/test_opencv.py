"""OpenCV's calibrated responses, judged by OpenCV itself where it is installed."""

import numpy as np
import pytest

from crfnet.errors import LutError
from crfnet.interchange.files import read_response, write_response
from crfnet.luts.lut1d import Lut1D, inverse_response_lut

SUFFIXES = (".npy", ".yml", ".xml")


def response(columns):
    """What OpenCV would return for light of shape (256, 3) in the order R, G, B."""
    return np.asarray(columns, dtype=np.float32)[:, None, ::-1]


def powers(*exponents):
    return np.stack([((np.arange(256) + 0.5) / 255.5) ** exponent for exponent in exponents], axis=1)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_written_is_read_back(tmp_path, rgb_lut, suffix):
    write_response(tmp_path / f"a{suffix}", rgb_lut)
    found = read_response(tmp_path / f"a{suffix}").lut
    codes = np.linspace(0, 1, 256)[1:]
    for channel, expected in zip(found.channels, rgb_lut.channels, strict=True):
        assert np.abs(channel.apply(codes) - expected.apply(codes)).max() < 1e-6


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_opencv_reads_what_is_written(tmp_path, rgb_lut, suffix):
    cv2 = pytest.importorskip("cv2", reason="needs OpenCV")
    path = tmp_path / f"a{suffix}"
    write_response(path, rgb_lut)
    if suffix == ".npy":
        table = np.load(path)
    else:
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
        table = storage.getNode("response").mat()
    assert (table.shape, table.dtype) == ((256, 1, 3), np.float32)
    assert table[128, 0, 1] == 1  # green at the middle code, the scale of OpenCV's calibration
    assert (table > 0).all()


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("method", ["Debevec", "Robertson"])
def test_what_opencv_calibrates_is_read(tmp_path, series, curves, method, suffix):
    cv2 = pytest.importorskip("cv2", reason="needs OpenCV")
    images = [cv2.imread(str(path)) for path in series]
    calibrate = cv2.createCalibrateDebevec(samples=200) if method == "Debevec" else cv2.createCalibrateRobertson()
    table = calibrate.process(images, times=np.array(list(series.values()), dtype=np.float32))
    path = tmp_path / f"a{suffix}"
    if suffix == ".npy":
        np.save(path, table)
    else:
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
        storage.write("response", table)
        storage.release()
    found = read_response(path)
    assert found.words == "OpenCV response (channels B, G, R), R, G and B apart, from code values to light"
    codes = np.arange(20, 250) / 255
    for channel, curve in zip(found.lut.channels, curves, strict=True):
        shape = channel.apply(codes) / channel.apply(np.array([128 / 255]))
        assert np.abs(np.log2(shape / (curve.inverse(codes) / curve.inverse(128 / 255)))).max() < 0.1  # stops


def test_opencv_merges_a_series_with_what_is_written(tmp_path, series, light, rgb_lut):
    cv2 = pytest.importorskip("cv2", reason="needs OpenCV")
    write_response(tmp_path / "a.npy", rgb_lut)
    images = [cv2.imread(str(path)) for path in series]
    times = np.array(list(series.values()), dtype=np.float32)
    merged = cv2.createMergeDebevec().process(images, times=times, response=np.load(tmp_path / "a.npy"))[..., ::-1]
    ratio = np.log2(merged / light)
    assert np.abs(ratio - np.median(ratio, axis=(0, 1))).max() < 0.05  # stops
    assert np.ptp(np.median(ratio, axis=(0, 1))) < 0.01  # the channels in the right order, and of one scale


def test_gaps_and_noise_are_mended_and_said(tmp_path):
    columns = powers(2.2, 1.8, 2.0)
    columns[:3] = np.nan
    columns[100] = columns[98]
    columns[255] *= 4
    np.save(tmp_path / "a.npy", response(columns))
    found = read_response(tmp_path / "a.npy")
    gaps, clipped, moved, scaled = found.notes
    assert gaps == "3 codes that no picture held are interpolated"
    assert clipped == "The largest code, which stands for clipped light too, is extrapolated"
    assert moved.startswith("Made to increase, which moved it by up to ")
    assert scaled == "Scaled so that white, of green, is 1"
    assert found.lut.comments[1:] == found.notes
    assert found.lut.channels[1].values[-1] == 1


def test_channels_that_agree_are_one_table(tmp_path):
    np.save(tmp_path / "a.npy", response(powers(2.2, 2.2, 2.2)))
    assert isinstance(read_response(tmp_path / "a.npy").lut, Lut1D)
    np.save(tmp_path / "gray.npy", powers(2.2).astype(np.float32)[:, None])
    assert isinstance(read_response(tmp_path / "gray.npy").lut, Lut1D)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (np.ones((3, 3)), r"has shape \(3, 3\); OpenCV's responses have \(256, 1, 3\)"),
        (np.ones((256, 1, 3)), "is not brighter for larger codes"),
        (powers(-1, -1, -1), "is not brighter for larger codes"),
        (np.full((256, 1, 3), np.nan), "holds light for 0 codes"),
        (np.array(["a", "b"]), "is no .npy file of numbers"),
        (
            np.linspace(0, 1, 256)[:, None, None] * np.array([1e40, 1, 1]),
            r"a.npy: entry \d+ of the LUT, .*; calibrate again",
        ),
    ],
)
def test_what_is_no_response_is_refused(tmp_path, table, message):
    np.save(tmp_path / "a.npy", table)
    with pytest.raises(LutError, match=message):
        read_response(tmp_path / "a.npy")


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.npy", b"nothing", "is no .npy file of numbers"),
        ("a.yml", b"%YAML:1.0\n---\nx: 1\n", "holds no matrix as cv2.FileStorage writes it"),
        ("a.yml", b'r: !!opencv-matrix\n   rows: 256\n   cols: 1\n   dt: "3f"\n   data: [ 1, 2 ]\n', "256 x 1 values"),
    ],
)
def test_damaged_files_are_refused(tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(LutError, match=message):
        read_response(tmp_path / name)
    with pytest.raises(LutError, match="cannot be read"):
        read_response(tmp_path / f"none{name}")


def test_a_file_is_replaced_only_when_asked(tmp_path, true_response):
    lut = inverse_response_lut(true_response)
    write_response(tmp_path / "a.npy", lut)
    with pytest.raises(LutError, match="exists already"):
        write_response(tmp_path / "a.npy", lut)
    write_response(tmp_path / "a.npy", lut, overwrite=True)

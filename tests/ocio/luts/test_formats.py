from functools import partial

import colour
import numpy as np
import PyOpenColorIO as OCIO
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from crfnet.errors import LutError
from crfnet.luts.files import WRITERS, read_lut, write_lut
from crfnet.luts.lut1d import Lut1D, inverse_response_lut, strictly_increasing
from crfnet.luts.rgb_lut import lut_identity
from crfnet_core import CRFNetError, ResponseCurve
from tests.helpers.configs import through_lut
from tests.helpers.refusals import refusal_of

LUT = Lut1D([-0.1, 0.0, 1e-7, 1.25], domain=(-0.125, 1.125), comments=("photo: <a> & b.jpg", "model: crf é"))
SPI1D = """\
# photo: <a> & b.jpg
# model: crf é
Version 1
From -0.125 1.125
Length 4
Components 1
{
  -0.100000001
  0
  1.00000001e-07
  1.25
}
"""
CUBE = """\
# photo: <a> & b.jpg
# model: crf é
LUT_1D_SIZE 4
DOMAIN_MIN -0.125 -0.125 -0.125
DOMAIN_MAX 1.125 1.125 1.125
-0.100000001 -0.100000001 -0.100000001
0 0 0
1.00000001e-07 1.00000001e-07 1.00000001e-07
1.25 1.25 1.25
"""
CLF = """\
<?xml version="1.0" encoding="UTF-8"?>
<ProcessList xmlns="urn:AMPAS:CLF:v3.0" id="{id}" compCLFversion="3.0">
    <Description>photo: &lt;a&gt; &amp; b.jpg</Description>
    <Description>model: crf é</Description>
    <Range inBitDepth="32f" outBitDepth="32f">
        <minInValue>-0.125</minInValue>
        <maxInValue>1.125</maxInValue>
        <minOutValue>0</minOutValue>
        <maxOutValue>1</maxOutValue>
    </Range>
    <LUT1D inBitDepth="32f" outBitDepth="32f" interpolation="linear">
        <Array dim="4 1">
-0.100000001
0
1.00000001e-07
1.25
        </Array>
    </LUT1D>
</ProcessList>
"""


def test_the_texts_are_the_expected_ones(tmp_path):
    texts = {".spi1d": SPI1D, ".cube": CUBE, ".clf": CLF.format(id=lut_identity(LUT))}
    for suffix in WRITERS:
        write_lut(tmp_path / f"a{suffix}", LUT)
        assert (tmp_path / f"a{suffix}").read_bytes() == texts[suffix].encode()
    assert len(list(tmp_path.iterdir())) == len(WRITERS)


def test_the_identity_depends_on_the_table_and_the_domain_alone():
    assert lut_identity(LUT) == lut_identity(Lut1D(LUT.values, LUT.domain))
    different = (LUT, Lut1D(LUT.values), Lut1D(LUT.values * 2, LUT.domain))
    assert len(set(map(lut_identity, different))) == 3


def test_opencolorio_sees_the_id_and_the_descriptions_of_a_clf(tmp_path):
    write_lut(tmp_path / "a.clf", LUT)
    metadata = OCIO.Config.CreateRaw().getProcessor(OCIO.FileTransform(src=str(tmp_path / "a.clf"))).getFormatMetadata()
    assert metadata.getID() == lut_identity(LUT)
    assert [child.getElementValue() for child in metadata.getChildElements()] == list(LUT.comments)


SUFFIXES = tuple(WRITERS)
EXTENDED = (-0.125, 1.125)
UNIFORM = np.linspace(0, 1, 1024)
CURVES = {
    "gamma": ResponseCurve.gamma(2.2),
    "identity": ResponseCurve.gamma(1),
    "clipped early": ResponseCurve.from_samples(np.clip(20 * UNIFORM, 0, 1)),
    "crushed blacks": ResponseCurve.from_samples(UNIFORM**8),
    "jump": ResponseCurve.from_samples(UNIFORM > 0.5),
}


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("suffix", SUFFIXES)
class TestRoundTrip:
    @pytest.mark.parametrize(("length", "domain"), [(4081, (0, 1)), (5101, EXTENDED)])
    def test_opencolorio_agrees_with_numpy_in_both_directions(self, tmp_path, suffix, name, length, domain, tolerance):
        path = tmp_path / f"a{suffix}"
        lut = inverse_response_lut(CURVES[name], length=length, domain=domain)
        write_lut(path, lut)
        values = np.append(np.linspace(-0.5, 2, 5000, dtype=np.float32), np.float32([np.inf, -np.inf]))
        assert np.abs(through_lut(path, values) - lut.apply(values)).max() < tolerance.lut
        assert through_lut(path, [np.nan]) == lut.apply(np.float32([np.nan])) == np.float32(lut.values[0])
        backwards = through_lut(path, values, OCIO.TRANSFORM_DIR_INVERSE)
        assert np.abs(backwards - lut.apply_inverse(values)).max() < tolerance.lut

    @pytest.mark.parametrize(("length", "bits"), [(4081, 8), (4093, 10)])
    def test_opencolorio_gives_all_codes_back(self, tmp_path, suffix, name, length, bits):
        path = tmp_path / f"a{suffix}"
        write_lut(path, inverse_response_lut(CURVES[name], length=length))
        linear = through_lut(path, np.arange(2**bits) / (2**bits - 1))
        # Hosts use the default optimization, whose inverse is approximate; it must still give every code back.
        for optimization in (OCIO.OPTIMIZATION_LOSSLESS, OCIO.OPTIMIZATION_DEFAULT):
            back = through_lut(path, linear, OCIO.TRANSFORM_DIR_INVERSE, optimization)
            assert np.rint(back * (2**bits - 1)).tolist() == list(range(2**bits))


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize(
    ("suffix", "reader"), [(".spi1d", colour.io.read_LUT_SonySPI1D), (".cube", colour.io.read_LUT_IridasCube)]
)
def test_colour_science_agrees_with_numpy(tmp_path, suffix, reader, name, tolerance):
    path = tmp_path / f"a{suffix}"
    lut = inverse_response_lut(CURVES[name], length=5101, domain=EXTENDED, comments=("photo: a.jpg",))
    write_lut(path, lut)
    values = np.linspace(*EXTENDED, 3000)
    result = reader(str(path)).apply(np.repeat(values[:, np.newaxis], 3, axis=1))
    slope = np.diff(lut.values).max() * (lut.values.size - 1) / 1.25
    assert np.abs(result - lut.apply(values)[:, np.newaxis]).max() < max(tolerance.lut, slope * 1e-9)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(arrays(np.float32, st.integers(2, 60), elements=st.floats(-1e6, 1e6, width=32)), st.sampled_from(SUFFIXES))
def test_any_table_is_read_back_bit_for_bit_by_us_and_by_opencolorio(tmp_path, values, suffix):
    lut = Lut1D(strictly_increasing(np.sort(values)), domain=(-0.1, 1.3))
    path = tmp_path / f"any{suffix}"
    write_lut(path, lut, overwrite=True)
    assert read_lut(path) == lut
    OCIO.ClearAllCaches()
    steps = OCIO.Config.CreateRaw().getProcessor(OCIO.FileTransform(src=str(path))).createGroupTransform()
    assert np.array_equal(steps[1].getData()[::3], lut.values.astype(np.float32))


@pytest.mark.parametrize("suffix", [*SUFFIXES, *map(str.upper, SUFFIXES)])
def test_a_file_is_replaced_only_when_asked_and_by_a_lut(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    path.write_text("mine")
    assert refusal_of(LutError, write_lut, path, Lut1D([0, 1])).code == "exists"
    paths = (partial(read_lut, name) for name in (5, "a\0.cube", "\ud800.cube"))
    for call in (partial(write_lut, path, 5, overwrite=True), partial(inverse_response_lut, 5), *paths):
        assert refusal_of(CRFNetError, call).code == "argument_kind"
    assert path.read_text() == "mine"
    write_lut(path, Lut1D([0, 1]), overwrite=True)
    assert read_lut(str(path)) == Lut1D([0, 1])

import PyOpenColorIO as OCIO

from crfnet.luts.files import WRITERS, write_lut
from crfnet.luts.lut1d import Lut1D
from crfnet.luts.rgb_lut import lut_identity

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

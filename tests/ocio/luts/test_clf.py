"""The Common LUT Format."""

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.errors import LutError
from crfnet.luts.clf import read_clf, write_clf
from crfnet.luts.lut1d import Lut1D

LUT = Lut1D([-0.1, 0.0, 1e-7, 1.25], domain=(-0.125, 1.125), comments=("photo: <a> & b.jpg", "model: crf é"))
TEXT = """\
<?xml version="1.0" encoding="UTF-8"?>
<ProcessList xmlns="urn:AMPAS:CLF:v3.0" id="crfnet-{id}" compCLFversion="3.0">
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


def plain(rows="0\n0.5\n1", dim="3 1", before="", depth="32f", attributes=""):
    """A CLF file of one LUT1D."""
    return (
        f'<ProcessList id="x" compCLFversion="3.0">\n{before}'
        f'<LUT1D inBitDepth="32f" outBitDepth="{depth}"{attributes}>\n'
        f'<Array dim="{dim}">\n{rows}\n</Array>\n</LUT1D>\n</ProcessList>\n'
    )


def value_range(low="-1", high="2", zero="0", one="1", depth="32f"):
    """A Range before the LUT1D."""
    ends = f"<minInValue>{low}</minInValue><maxInValue>{high}</maxInValue>"
    ends += f"<minOutValue>{zero}</minOutValue><maxOutValue>{one}</maxOutValue>"
    return f'<Range inBitDepth="{depth}" outBitDepth="32f">{ends}</Range>\n'


def test_the_text_is_the_expected_one(tmp_path):
    write_clf(tmp_path / "a.clf", LUT)
    text = (tmp_path / "a.clf").read_text(encoding="utf-8")
    identity = text.partition('id="crfnet-')[2][:32]
    assert text == TEXT.format(id=identity)
    assert [path.name for path in tmp_path.iterdir()] == ["a.clf"]


def test_the_id_depends_on_the_table_and_the_domain_alone(tmp_path):
    luts = [LUT, Lut1D(LUT.values, LUT.domain), Lut1D(LUT.values), Lut1D(LUT.values * 2, LUT.domain)]
    for index, lut in enumerate(luts):
        write_clf(tmp_path / f"{index}.clf", lut)
    same, also, domain, table = ((tmp_path / f"{index}.clf").read_text().splitlines()[1] for index in range(4))
    assert same == also
    assert len({same, domain, table}) == 3


def test_the_text_is_read_back(tmp_path):
    (tmp_path / "a.clf").write_text(TEXT.format(id="any"), encoding="utf-8")
    assert read_clf(tmp_path / "a.clf") == LUT


def test_opencolorio_sees_the_id_and_the_descriptions(tmp_path):
    write_clf(tmp_path / "a.clf", LUT)
    processor = OCIO.Config.CreateRaw().getProcessor(OCIO.FileTransform(src=str(tmp_path / "a.clf")))
    metadata = processor.getFormatMetadata()
    assert metadata.getID().startswith("crfnet-")
    assert [child.getElementValue() for child in metadata.getChildElements()] == list(LUT.comments)


def test_what_opencolorio_writes_is_read(tmp_path):
    table = OCIO.Lut1DTransform(length=3, inputHalfDomain=False)
    table.setData(np.repeat([0, 0.25, 1], 3).astype(np.float32))
    group = OCIO.GroupTransform([OCIO.RangeTransform(-0.5, 1.5, 0, 1), table])
    group.getFormatMetadata().setID("x")
    group.getFormatMetadata().addChildElement("Description", "a camera")
    group.write("Academy/ASC Common LUT Format", str(tmp_path / "a.clf"), OCIO.Config.CreateRaw())
    assert read_clf(tmp_path / "a.clf") == Lut1D([0, 0.25, 1], domain=(-0.5, 1.5), comments=("a camera",))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (plain(), Lut1D([0, 0.5, 1])),
        (plain("0 0.5 1"), Lut1D([0, 0.5, 1])),
        (plain("0 0 0\n0.5 0.5 0.5\n1 1 1", "3 3"), Lut1D([0, 0.5, 1])),
        (plain("0\n204\n1023", depth="10i"), Lut1D([0, 204 / 1023, 1])),
        (plain(before=value_range()), Lut1D([0, 0.5, 1], domain=(-1, 2))),
        (plain(before=value_range("0", "1023", depth="10i")), Lut1D([0, 0.5, 1])),
        (plain(before="<Info><AppRelease>1</AppRelease></Info>\n<!-- <Array> -->"), Lut1D([0, 0.5, 1])),
    ],
)
def test_what_others_write_is_read(tmp_path, text, expected):
    (tmp_path / "a.clf").write_text(text)
    assert read_clf(tmp_path / "a.clf") == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("no LUT at all", "line 1: is no well-formed XML"),
        (plain()[:-20], "line 8: is no well-formed XML"),
        ("<!DOCTYPE x [<!ENTITY a 'b'>]>" + plain(), "declares XML entities"),
        ("<html><body/></html>", "holds body; needed is a CLF of one LUT1D"),
        ("<ProcessList/>", "holds <ProcessList>; needed is a CLF of one LUT1D"),
        (plain(before='<Matrix inBitDepth="32f" outBitDepth="32f"/>'), "holds Matrix, LUT1D; needed is"),
        (plain().replace("LUT1D", "LUT3D"), "holds LUT3D; needed is"),
        (plain("0\n1"), "holds 2 entries and announces 3"),
        (plain("0\n0.5\n0.7\n1"), "holds 4 entries and announces 3"),
        (plain("0\n0,5\n1"), "line 5: '0,5' is no number; decimals need a point, not a comma"),
        (plain("0\nnan\n1"), "line 5: nan is not finite"),
        (plain("0\n0.5\ninf"), "line 6: inf is not finite"),
        (plain("0\n0.5\n0.25"), "line 6: 0.25 is not above the value before it"),
        (plain("0 0\n0.5 0.5\n1 1", "3 2"), "has 2 channels"),
        (plain(dim=""), r"line 3: found 0 number\(s\), needed 2"),
        (plain(dim="3"), r"line 3: found 1 number\(s\), needed 2"),
        (plain(dim="many 1"), "line 3: 'many' is no number"),
        (plain(depth="9i"), "line 2: outBitDepth is '9i'; known are 8i, 10i, 12i, 16i, 16f, 32f"),
        (plain(attributes=' halfDomain="true"'), "line 2: is a LUT over half floats"),
        (plain().replace("Array", "Vector"), "line 2: the LUT1D has no Array"),
        (plain(before=value_range(one="2")), "line 2: the Range before the LUT1D must end in 0 to 1"),
        (plain(before=value_range(high="")), r"line 2: found 0 number\(s\), needed 1"),
        (plain(before=value_range(low="x")), "line 2: 'x' is no number"),
        (plain(before=value_range(low="3")), "finite domain from low to high, found 3 to 2"),
    ],
)
def test_what_is_no_lut_gets_one_line_that_names_it(tmp_path, text, message):
    path = tmp_path / "bad.clf"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(LutError, match=message) as caught:
        read_clf(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)

import numpy as np
import PyOpenColorIO as OCIO

from crfnet.luts.files import WRITERS, read_lut, write_lut
from crfnet.luts.lut1d import Lut1D, strictly_increasing
from crfnet.luts.rgb_lut import RgbLut1D
from tests.helpers.mutations import mutated, mutated_text

#: Words of each format that are put into its files, with bars between.
KEYWORDS = {
    ".cube": "LUT_1D_SIZE|LUT_3D_SIZE|LUT_1D_INPUT_RANGE|LUT_IN_VIDEO_RANGE|DOMAIN_MIN -1 -1 -1|DOMAIN_MAX|TITLE|#"
    "|\ufeff",
    ".spi1d": "Version|From|Length|Components|{|}|#|Version 2|\ufeff",
    ".clf": 'halfDomain="true"|rawHalfs="true"|hueAdjust="dw3"|interpolation="cubic"|interpolation="linear"'
    '|bypass="true"|inBitDepth="10i"|outBitDepth="8i"|outBitDepth="16f"|compCLFversion="9.0"|style="noClamp"|<!--|-->|&#48;|junk'
    "|<![CDATA[0.5]]>|<Range>|</Range>|<Description>|<minInValue>-1</minInValue>",
}


def random_lut(generator, *, most=4096):
    """A LUT of any length, scale and domain, of one table or three."""
    length = int(2 ** generator.uniform(1, np.log2(most)))
    steps = generator.exponential(size=(length, 3)) ** generator.integers(1, 5)
    scale = 10 ** generator.uniform(-3, 3)
    tables = (np.cumsum(steps, axis=0) / steps.sum(axis=0) - generator.choice([0, 0, 0.1])) * scale
    domain = ((0, 1), (0, 1), (-0.125, 1.125), (0, 10 ** generator.uniform(-2, 4)), (-1, 3))[generator.integers(5)]
    luts = tuple(Lut1D(strictly_increasing(column), domain) for column in tables.T)
    return RgbLut1D(luts) if generator.random() < 0.5 else luts[0]


def assert_opencolorio_agrees(path, lut):
    """The two agree on colors within and beyond the domain, but for float32's rounding of the place in the table."""
    OCIO.ClearAllCaches()
    processor = OCIO.Config.CreateRaw().getProcessor(OCIO.FileTransform(src=str(path)))
    low, high = lut.domain
    inputs = np.linspace(low - 0.5 * (high - low), high + 0.5 * (high - low), 999).astype(np.float32).reshape(-1, 3)
    found = inputs.copy()
    processor.getOptimizedCPUProcessor(OCIO.OPTIMIZATION_NONE).applyRGB(found)
    expected = lut.apply(inputs)
    steepest = max(np.diff(channel.values).max() for channel in lut.channels) * len(lut.values)
    place = float(np.finfo(np.float32).eps) * 4 * (1 + max(abs(low), abs(high)) / (high - low))
    tolerance = 1e-6 * max(1, np.abs(lut.values).max()) + steepest * place * (lut.domain != (0, 1))
    assert np.abs(found - expected).max() <= tolerance, f"{np.abs(found - expected).max()} above {tolerance}"


def test_random_luts_are_read_back_and_opencolorio_agrees(fuzz, tmp_path):
    def case(generator):
        path = tmp_path / f"a{generator.choice(list(WRITERS))}"
        lut = random_lut(generator)
        write_lut(path, lut, overwrite=True)
        assert read_lut(path) == lut
        assert_opencolorio_agrees(path, lut)

    fuzz(case)


CSP = (
    "CSPLUTV100\n1D\n\nBEGIN METADATA\nby hand\nEND METADATA\n\n"
    "2\n0 1\n0 1\n2\n0 1\n0 1\n2\n0 1\n0 1\n\n3\n0 0 0\n.2 .2 .2\n1 1 1\n"
)
DL3 = "".join(f"{4 * code} {4 * code} {4 * code}\n" for code in range(256))
HOUDINI = (
    "Version 1\nFormat any\nType C\nFrom 0 1\nTo 0 1\nBlack 0\nWhite 1\nLength 3\nLUT:\nPreL {\n0\n.5\n1\n}\n"
    "R {\n0\n.3\n1\n}\nG {\n0\n.3\n1\n}\nB {\n0\n.3\n1\n}\n"
)
SEEDS = {".csp": CSP, ".3dl": DL3, ".lut": HOUDINI}


def test_damaged_luts_are_read_as_opencolorio_reads_them_or_refused(fuzz, refused, tmp_path):
    """At least one in 50 is still read, so that there is something to compare; other programs' LUTs are sampled."""
    is_read = []

    def case(generator):
        suffix = str(generator.choice([*WRITERS, *SEEDS]))
        path = tmp_path / f"a{suffix}"
        if suffix in WRITERS:
            write_lut(path, random_lut(generator, most=24), overwrite=True)
        text = path.read_text() if suffix in WRITERS else SEEDS[suffix]
        if generator.random() < 0.7:
            words = KEYWORDS.get(suffix, "").split("|")
            path.write_bytes(mutated_text(text, generator, words).encode(errors="surrogatepass"))
        else:
            path.write_bytes(mutated(text.encode(), generator))
        is_read.append(not refused(read_lut, path))
        if is_read[-1] and suffix in WRITERS:
            assert_opencolorio_agrees(path, read_lut(path))

    fuzz(case)
    assert len(is_read) < 100 or np.mean(is_read) > 0.02

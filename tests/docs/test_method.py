import ast
import importlib
import math
import re
from inspect import signature

import pytest

from crfnet.luts.lut1d import MAX_END_SLOPE, inverse_response_lut
from crfnet_core.network import pooling
from crfnet_core.posterior import Family, ResponseBank, evidence, posterior, responses, verdict
from crfnet_core.response import curve, emor
from crfnet_core.statistics import (
    CUES,
    candidates,
    channel_equations,
    edges,
    gradients,
    mixing,
    sampling,
    shading,
    windows,
)

DOCUMENTS = ("*.md", "docs/*.md", "docs/*/*.md", "blender_addon/*.md")

DOTTED = re.compile(r"\b(?:crfnet_core|crfnet|training)(?:\.\w+)+")


def documents(root):
    return sorted({path for pattern in DOCUMENTS for path in root.glob(pattern)})


def exists(root, name):
    """Whether a dotted name is a module or a name in one; of training, whose torch need not be there, by its source."""
    parts = name.split(".")
    return any(is_in(root, parts[:size], parts[size:]) for size in range(len(parts), 0, -1))


def is_in(root, module, names):
    """Whether a module is there and has `names`, each within the one before it."""
    if module[0] == "training":
        path = root.joinpath(*module)
        source = next((file for file in (path / "__init__.py", path.with_suffix(".py")) if file.is_file()), None)
        text = source.read_text(encoding="utf-8") if source else ""
        return bool(source) and all(re.search(rf"^ *(class |def )?{name}\b", text, re.MULTILINE) for name in names)
    try:
        value = importlib.import_module(".".join(module))
    except ModuleNotFoundError:
        return False
    for name in names:
        if not hasattr(value, name) and name not in getattr(value, "__annotations__", {}):
            return False
        value = getattr(value, name, None)
    return True


def test_every_function_that_a_document_names_is_there(root):
    names = {name for path in documents(root) for name in DOTTED.findall(path.read_text(encoding="utf-8"))}
    assert len(names) > 30
    assert not [name for name in names if not exists(root, name)]


def test_every_file_that_a_document_names_is_there(root):
    pattern = re.compile(r"`((?:crfnet_core|ocio|blender_addon|training|tests|docs)/[\w./]+)`")
    texts = {path: path.read_text(encoding="utf-8") for path in documents(root)}
    named = {name for text in texts.values() for name in pattern.findall(text) if "NAME" not in name}
    assert len(named) > 30
    assert not [name for name in named if not (root / name).exists()]


def equations(root):
    """The numbers of the equations: of the method, of log footage (L.1), and of a calibration (C.1)."""
    texts = [(root / "docs" / name).read_text(encoding="utf-8") for name in ("METHOD.md", "CALIBRATE.md")]
    return [number for text in texts for number in re.findall(r"\\tag\{(.*?)\}", text)]


@pytest.mark.parametrize("prefix", ["", "L.", "C."])
def test_the_equations_are_numbered_without_a_gap(root, prefix):
    numbers = [number for number in equations(root) if re.fullmatch(re.escape(prefix) + r"\d+", number)]
    assert numbers
    assert numbers == [f"{prefix}{index + 1}" for index in range(len(numbers))]


def test_every_equation_that_is_cited_is_there(root):
    code = [path for package in ("crfnet_core", "ocio", "training") for path in (root / package).rglob("*.py")]
    sources = [*code, *documents(root)]
    cited = {
        number
        for path in sources
        for text in re.findall(
            r"\bEq\. ((?:[LC]\.)?\d+(?:(?:, | and | to )(?:[LC]\.)?\d+)*)", path.read_text(encoding="utf-8")
        )
        for number in re.findall(r"(?:[LC]\.)?\d+", text)
    }
    assert cited
    assert not cited - set(equations(root))


def test_the_six_main_equations_have_the_numbers_that_the_code_cites(root):
    text = (root / "docs" / "METHOD.md").read_text(encoding="utf-8")
    bodies = {int(number): body for body, number in re.findall(r"```math\n(.*?)\\tag\{(\d+)\}", text, re.DOTALL)}
    parts = {1: "f_0(E)", 2: "(1 - \\alpha) \\, g(a)", 3: "h \\, k(m)", 4: "\\log p(b)", 5: "\\rho(d)", 6: "\\log g(a)"}
    assert not [number for number, part in parts.items() if part not in bodies[number]]


@pytest.mark.parametrize(
    "sentence",
    [
        f"\\sum_{{j=1}}^{{{emor.COMPONENTS}}}",
        f"squares of {windows.WINDOW_SIZE} x {windows.WINDOW_SIZE} samples",
        f"at least {windows.FULL_COVERAGE} of the 256 bins",
        f"After {windows.POSITIONS_TRIED} draws",
        f"{windows.WINDOWS_PER_PHOTOGRAPH} in a photograph",
        f"\\min(H, W) / {windows.WINDOWS_ACROSS * windows.WINDOW_SIZE}",
        f"Of each channel at {gradients.LEVELS} levels",
        f"{edges.GRID} x {edges.GRID} cells",
        f"at two of {channel_equations.EQUATION_LEVELS} levels",
        f"asked of {candidates.CANDIDATE_COUNT} candidates, {len(candidates.FIRST_WEIGHTS)} values",
        f"edges of more than {edges.LEAST_EDGE_HEIGHT} codes",
        f"higher than {channel_equations.LEAST_COMPARED_HEIGHT} codes",
        f"differ by {channel_equations.MOST_RATIO_DIFFERENCE} or more",
        f"mixtures of more than {sampling.LEAST_HEIGHT} codes",
        "by at most 1/{}, or by at most 1/{}".format(*sampling.ISOLATION),
        f"times {len(candidates.SECOND_WEIGHTS)} of $w_2$",
        f"{candidates.IDENTITY_FRACTION:.0%}".replace("%", " % of the identity"),
        f"$s = {mixing.RATIO_NOISE}$",
        f"by more than {mixing.LEAST_DIFFERENCE} codes",
        f"1/{mixing.INNER} of the edge's height",
        f"({shading.LITTLE[0]} to {shading.LITTLE[1]} codes)",
        f"({shading.MUCH[0]} to {shading.MUCH[1]})",
        f"s = {shading.OTHER_CHANGE} ",
        f"The factor {pooling.OUTLIER_FACTOR:g} is ours",
        f"\\varepsilon = 10^{{{math.log10(curve.LEAST_SLOPE):.0f}}}",
        f"Student's t with {evidence.DEGREES_OF_FREEDOM:g} degrees of freedom",
        f"first {evidence.EVIDENCE_WEIGHTS} EMoR weights",
        f"\\frac{{{evidence.DEGREES_OF_FREEDOM:g} + {evidence.EVIDENCE_WEIGHTS}}}{{2}}",
        f"holds {len(ResponseBank.load().families)} responses in eight families",
        f"| developed | {ResponseBank.load().families.count(Family.DEVELOPED)} |",
        f"| film | {ResponseBank.load().families.count(Family.FILM)} |",
        f"with a probability of {posterior.BAND:.0%}".replace("%", " %"),
        f"at {len(responses.BAND_SAMPLES)} irradiances",
        f"or $u_{{stops}}$ is above {verdict.USABLE_STOPS:g}",
        f"at {signature(inverse_response_lut).parameters['length'].default} uniform brightnesses",
        f"at most {MAX_END_SLOPE:g}",
    ],
)
def test_the_numbers_of_the_method_are_those_of_the_code(root, sentence):
    text = " ".join((root / "docs" / "METHOD.md").read_text(encoding="utf-8").split())
    assert sentence in text


@pytest.mark.parametrize(
    ("module", "constant", "sentence"),
    [
        ("features", "SAMPLE_PSEUDO_COUNT", "a pseudo-count $n_0$ of {0:g} (levels and edges) or {1:g} (candidates)"),
        ("features", "SMOOTHNESS", "\\lambda \\in \\{{ {0:g}, {1:g} \\}}"),
        ("features", "CURVATURE_PSEUDO_EVIDENCE", "$\\mu = {0:g}$ squared codes"),
        ("features", "CURVATURE_UNIT", "divided by {0:g} and limited to -{1:g} to {1:g}"),
        ("model", "LARGEST_FEATURE", "limited to {0:g} standard deviations"),
        ("train", "COMPETITORS", "$M = {0:g}$ training photographs"),
        ("loss", "WINDOW_WEIGHT", "plus {0:g} times the same for each window by itself"),
        ("loss", "WINDOW_WEIGHT", "+ {1:g} \\left\\| w^* - \\bar{{w}} \\right\\|"),
        ("../data/in_camera", "COMPONENTS", "\\sum_{{j=1}}^{{{0:g}}} s_j"),
        ("../data/in_camera", "TAILS", "\\mathcal{{N}}(0, {0:g}^2)"),
    ],
)
def test_the_numbers_of_the_network_are_those_of_the_code(root, module, constant, sentence):
    """Read from the syntax tree, so that torch need not be there."""
    tree = ast.parse((root / "training" / "network" / f"{module}.py").read_text(encoding="utf-8"))
    assigned = (node for node in tree.body if isinstance(node, ast.Assign))
    values = next(node.value for node in assigned if constant in ast.unparse(node.targets[0]))
    numbers = ast.literal_eval(values)
    text = " ".join((root / "docs" / "METHOD.md").read_text(encoding="utf-8").split())
    assert sentence.format(*(numbers if isinstance(numbers, tuple) else (numbers,))) in text


def test_the_table_of_cues_is_that_of_the_code(root):
    rows = [f"| {cue.name} | {' x '.join(map(str, cue.shape))} | {cue.meaning} | " for cue in CUES]
    text = (root / "docs" / "METHOD.md").read_text(encoding="utf-8")
    table = text.partition("| cue | shape | sums | symbol |\n| --- | --- | --- | --- |\n")[2].partition("\n\n")[0]
    assert [line[: len(row)] for line, row in zip(table.splitlines(), rows, strict=True)] == rows


def test_the_references_are_complete(root):
    text = (root / "docs" / "REFERENCES.bib").read_text(encoding="utf-8")
    entries = re.findall(r"^@\w+\{(\w+),(.*?)^\}", text, re.MULTILINE | re.DOTALL)
    assert len(entries) >= 11
    assert len({key for key, _ in entries}) == len(entries)
    assert not [key for key, body in entries if "title" not in body or "author" not in body]
    assert not [doi for doi in re.findall(r"doi\s*=\s*\{(.*?)\}", text) if not re.fullmatch(r"10\.\d{4,}/\S+", doi)]

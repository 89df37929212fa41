"""Every error and notice has one sentence, every sentence is used, and it names the facts that it is given."""

import ast
import pickle
import re
from pathlib import Path
from string import Formatter

import pytest

import crfnet.messages
import crfnet_core.messages
from crfnet.cli import remedies
from crfnet.errors import OutputError
from crfnet_core.errors import CRFNetError, Notice, PhotoError

ROOT = Path(__file__).parents[1]
PACKAGES = {"crfnet_core": crfnet_core.messages.SENTENCES, "ocio": crfnet.messages.SENTENCES}


def stated(package):
    """Yield (place, code, names of the facts) of every error and notice that a package makes with a code.

    A sentence in place of a code has spaces; a code that is not a literal cannot be read from the text.
    """
    for path in sorted((ROOT / package).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if not isinstance(node, ast.Call) or not node.args:
                continue
            name = getattr(node.func, "id", getattr(node.func, "attr", ""))
            code = getattr(node.args[0], "value", None)
            if not (name.endswith("Error") or name == "Notice") or not isinstance(code, str) or " " in code:
                continue
            if name == "CommandError":
                continue
            if name == "Notice":
                facts = node.args[1] if len(node.args) > 1 else None
                names = {key.value for key in facts.keys} if isinstance(facts, ast.Dict) else set()
            else:
                names = {keyword.arg for keyword in node.keywords}
            yield f"{path.relative_to(ROOT)}:{node.lineno}", code, names


def needed(sentence):
    return {name for _, name, _, _ in Formatter().parse(sentence) if name}


@pytest.mark.parametrize("package", PACKAGES)
def test_every_code_has_a_sentence_and_every_sentence_its_facts(package):
    places, sentences = list(stated(package)), {**PACKAGES["crfnet_core"], **PACKAGES[package]}
    assert len(places) > 50
    for place, code, facts in places:
        assert code in sentences, f"{place}: no sentence for {code}"
        assert None in facts or needed(sentences[code]) <= facts, f"{place}: {code} lacks facts"


@pytest.mark.parametrize("package", PACKAGES)
def test_every_sentence_is_used(package):
    text = "".join(path.read_text("utf-8") for path in (ROOT / package).rglob("*.py") if path.name != "messages.py")
    assert [code for code in PACKAGES[package] if f'"{code}"' not in text] == []


def test_codes_are_names_and_belong_to_one_package():
    codes = [code for sentences in PACKAGES.values() for code in sentences]
    assert len(set(codes)) == len(codes)
    assert all(re.fullmatch("[a-z][a-z0-9_]*", code) for code in codes)


def test_no_sentence_names_an_option_or_a_british_spelling():
    british = re.compile("colour|grey|linearis|analys|cancelled|centre", re.IGNORECASE)
    for sentences in PACKAGES.values():
        for code, sentence in sentences.items():
            assert not re.search(r"(^|\s|\()--?[a-z]|\bcrfnet [a-z]", sentence), code
            assert not british.search(sentence), code


def test_an_error_says_its_sentence_with_its_facts_on_one_line(monkeypatch):
    monkeypatch.setattr(CRFNetError, "sentences", {"too_small": "{path}: {width} samples are too few"})
    problem = PhotoError("too_small", path="a\x1b\nb.jpg", width=3)
    assert (problem.code, problem.facts["width"]) == ("too_small", 3)
    assert str(problem) == "a? b.jpg: 3 samples are too few"


def test_errors_survive_pickling():
    problem = pickle.loads(pickle.dumps(OutputError("exists", path="a")))
    assert (problem.code, problem.facts) == ("exists", {"path": "a"})


def test_an_unknown_code_is_its_own_sentence():
    assert str(Notice("unknown", {"path": "{x}"})) == "unknown"


def test_the_command_has_a_remedy_only_for_errors_that_are_raised():
    known = {code for sentences in PACKAGES.values() for code in sentences}
    assert set(remedies.REMEDIES) <= known
    assert not set(remedies.SENTENCES) & known
    text = "".join(path.read_text("utf-8") for path in (ROOT / "ocio/cli").rglob("*.py"))
    assert all(f'CommandError("{code}"' in text for code in remedies.SENTENCES)

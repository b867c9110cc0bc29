"""The field's words stand in titles, summary lines, captions and error messages.

Each entry of `WORDS` is a form that reads foreign, or a coinage, and the word of the field. Words
that the glossary introduces beside their standard names (twin, blind direction) may be used.
"""

import ast
import re
from pathlib import Path

import pytest

from tools.notebooks import chapters, stored_cells

ROOT = Path(__file__).resolve().parents[1]
LIBRARY = ROOT / "dopplerlib"
PAGES = chapters() + sorted((ROOT / "book").glob("*.md"))
PACKAGES = (
    "model",
    "signal",
    "estimation",
    "tracking",
    "chain",
    "evaluation",
    "workspace",
    "replication",
    "systems",
    "figures",
    "commandline",
)

WORDS = {
    r"form of Joseph": "Joseph form",
    r"\bshares? of\b": "fraction or proportion",
    r"\bchances?\b": "probability",
    r"(?<![Ss]tandard )(?<![Dd]ocumented )\bdeviations?\b": "standard deviation",
    r"\bsupposed\b": "assumed",
    r"\bright filter\b": "consistent filter",
    r"\b(no|lag-one) memory\b": "autocorrelation, whiteness",
    r"\bright angles\b": "orthogonal",
    r"\bbends?\b": "curvature",
    r"\bwhoever\b|\bnobody\b": "a subject",
    r"\b(is|are|was|be) (told|said)\b|\btells\b": "states, reports, reads",
    r"\b(so|how) (well|good)\b": "accuracy",
    r"\bhow (often|many|far|much|long|likely|old)\b": "number, fraction, distance, length, age",
    r"^(What|Why|Which|How (?!to\b))\b|^Return (what|how)\b": "a noun as subject",
    r"(?<!knows )\b[Ww]hat (a|an|the|is|are|was|were|it|of|comes|stands)\b": "a noun as subject",
    r"\bnot to be (seen|known)\b|\bcannot see\b": "unobservable",
    r"\bno sound\b": "not valid",
    r"\bdie out\b|\bsettles\b": "stable, converges",
    r"\bworth\b": "effective sample size",
    r"\bmoments?\b(?! of)": "time",
    r"\bConfidenceInterval (a|states)\b": "estimate",
}


# A document publishes, states or reports; what this project prints is code and its results.
PUBLISHED = re.compile(
    r"\b[Aa]s printed\b|\bprinted (?:in|by) (?:the|Tables?|Figs?|Eqs?|Section)\b|\b[Tt]he printed "
    r"(?!blocks|code|forms?|formulas|function|kernels?|programs?|text|thesis)\w+"
)


def found(text):
    """Return the words of a text that have a better one, each with that."""
    hits = ((re.search(pattern, text), better) for pattern, better in WORDS.items())
    return [f"{hit[0]!r}: rather {better}" for hit, better in hits if hit]


def summary_lines(tree):
    """Yield the line and the first line of every docstring."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
            doc = ast.get_docstring(node)
            if doc:
                yield getattr(node, "lineno", 1), doc.partition("\n")[0]


def messages(tree):
    """Yield the line and the constant text of every error that is raised."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            constants = (c.value for c in ast.walk(node.exc) if isinstance(c, ast.Constant))
            text = " ".join(c for c in constants if isinstance(c, str))
            yield node.lineno, text


@pytest.mark.parametrize("package", PACKAGES)
@pytest.mark.parametrize("texts", [summary_lines, messages])
def test_the_library_speaks_as_the_field_does(package, texts):
    strange = [
        f"{path.relative_to(ROOT).as_posix()}:{line}: {text!r} {words}"
        for path in sorted((LIBRARY / package).rglob("*.py"))
        for line, text in texts(ast.parse(path.read_text(encoding="utf-8")))
        if (words := found(text))
    ]
    assert strange == [], "\n".join(strange)


def titles_and_captions(path):
    """Yield the headings of a page, and the captions of its figures."""
    if path.suffix == ".md":
        yield from re.findall(r"^#+ (.+)$", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
        return
    for cell in stored_cells(path):
        if cell.cell_type == "markdown":
            yield from re.findall(r"^#+ (.+)$", cell.source, flags=re.MULTILINE)
        yield cell.metadata.get("mystnb", {}).get("figure", {}).get("caption", "")


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_titles_and_captions_do_so_too(path):
    strange = [(text, words) for text in titles_and_captions(path) if (words := found(text))]
    assert strange == []


def test_a_document_publishes_and_does_not_print():
    files = [
        *(path for kind in ("*.toml", "*.md") for path in (ROOT / "data").rglob(kind)),
        *(ROOT / "book").glob("*.md"),
        *(ROOT / "book" / "reference").glob("*.md"),
        *LIBRARY.rglob("*.py"),
    ]
    texts = {path.relative_to(ROOT): path.read_text(encoding="utf-8") for path in files}
    for path in chapters():
        texts[path.name] = "\n".join(cell.source for cell in stored_cells(path))
    printed = {name: hit[0] for name, text in texts.items() if (hit := PUBLISHED.search(text))}
    assert printed == {}


@pytest.mark.parametrize("text", ["Eq 10 as printed", "printed in Table 2", "the printed estimate"])
def test_what_a_document_prints_is_found(text):
    assert PUBLISHED.search(text) and not PUBLISHED.search("the printed kernels")


@pytest.mark.parametrize(
    "text",
    [
        "Return the state after a measurement, in the form of Joseph.",
        "What a Kalman filter believes.",
        "How the filter of one radar is set.",
        "Return how many independent values an average is worth.",
        "Return the share of runs that are lost.",
        "Fuse two estimates of which nobody knows the correlation.",
        "Return the errors in units of their deviations.",
        "a.wav is no sound WAV file",
        "Return the covariance to which the filter settles.",
    ],
)
def test_a_form_that_reads_foreign_is_found(text):
    assert found(text)


@pytest.mark.parametrize(
    "text",
    [
        "Measurement update of the linear Kalman filter (Joseph form).",
        "Fuse two estimates with unknown cross-correlation.",
        "Return the twin of a state: the unobservable direction of a ring.",
        "Standard deviation of each frequency in Hz.",
    ],
)
def test_the_words_of_the_field_are_not(text):
    assert found(text) == []

"""What stands around the text of a page, and the links that nobody has to write."""

import importlib.util
import json
import re
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from docutils import nodes
from docutils.utils import new_document
from sphinx_exercise.nodes import exercise_enumerable_node, solution_node

from tools.notebooks import HERO, first_picture

ROOT = Path(__file__).resolve().parents[2]
BOOK = ROOT / "book"
STYLE = (BOOK / "_static" / "custom.css").read_text(encoding="utf8")
# Backgrounds of the theme in light mode: page, stripe of a table, box of an exercise.
BACKGROUNDS = {"page": "#ffffff", "stripe": "#f3f4f5", "box": "#ecf3ff"}


def extension(name):
    spec = importlib.util.spec_from_file_location(name, BOOK / "_ext" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


page, words, equations = extension("page"), extension("words"), extension("equations")
exercises = extension("exercises")
sooner = extension("sooner")


def paragraph(text):
    return nodes.paragraph("", text)


def section(*children):
    return nodes.section("", *children)


def test_the_picture_of_the_readme_is_the_first_of_the_book():
    chapter, picture = HERO
    notebook = json.loads(chapter.read_text(encoding="utf8"))
    assert picture.read_bytes() == first_picture(notebook)
    assert picture.relative_to(ROOT).as_posix() in (ROOT / "README.md").read_text(encoding="utf8")
    assert picture == BOOK / "_static" / page.PICTURE


def test_a_description_ends_with_a_sentence_and_has_no_formula():
    first = paragraph("A radar measures ")
    first += [nodes.math("", "f"), nodes.Text("shifts. " + "Nothing else. " * 20)]
    box = nodes.admonition("", paragraph("You will."))
    text = page.description(section(box, first))
    assert text.startswith("A radar measures shifts. Nothing else.")
    assert text.endswith("else.") and len(text) <= page.LONGEST
    needed = paragraph("The errors of ")
    needed += [nodes.math("", "x"), nodes.Text(" and "), nodes.math("", "y"), nodes.Text(" fall.")]
    assert page.description(section(needed, paragraph("They say how. B et al. do."))) == (
        "They say how. B et al. do."
    )
    assert page.description(section(paragraph("word " * 80))).endswith("word …")
    assert page.description(section(box)) == ""


def test_ids_of_exercises_become_different_ones():
    twins = [nodes.section(ids=["exercise-content"]), nodes.section(ids=["exercise-content"])]
    other = nodes.section(ids=["sec-a"])
    page.unique_ids(None, nodes.container("", *twins, other))
    assert [s["ids"][0] for s in (*twins, other)] == [
        "exercise-content-1",
        "exercise-content-2",
        "sec-a",
    ]


def test_an_exercise_says_whether_it_takes_paper_a_computer_or_an_afternoon():
    def exercise(label, *classes):
        content = nodes.section("", paragraph("Show it."))
        return exercise_enumerable_node("", content, label=label, classes=list(classes))

    cell = nodes.container(nb_element="cell_code")
    tree = section(
        *(exercise("a"), solution_node("", paragraph("So."), target_label="a")),
        *(exercise("b"), solution_node("", section(cell), target_label="b")),
        *(exercise("d", "hand"), solution_node("", section(cell.deepcopy()), target_label="d")),
        exercise("c", "project"),
    )
    exercises.grade(None, tree)
    texts = [node.astext() for node in tree.findall(nodes.paragraph) if "grade" in node["classes"]]
    hand, computer = exercises.BY_HAND, exercises.COMPUTER
    assert texts == [hand, computer, hand, exercises.PROJECT]


def test_a_head_that_is_empty_is_none_and_one_with_text_stays():
    text = '<tr><th scope="col"></th><th class="head"><p></p></th><th scope="col">a</th></tr>'
    assert page.repaired(text) == '<tr><td></td><td></td><th scope="col">a</th></tr>'
    assert 'role="list"' in page.repaired('<div role="list"></div>')
    assert "role" not in page.repaired('<div role="list" class="citation-list"></div>')


def test_a_hyphen_before_a_number_is_printed_as_a_minus_but_not_in_code():
    tree = section(paragraph("at -4 dB (-5), 3-4, x-1, 2e-09"))
    tree += nodes.paragraph("", "", nodes.literal("", "a -4"), nodes.emphasis("", "-2 m"))
    page.true_signs(None, tree)
    assert tree[0].astext() == "at \u22124 dB (\u22125), 3-4, x-1, 2\u00b710\u207b\u2079"
    assert tree[1].astext() == "a -4\u22122 m"
    table = "<td>-1 (-2 to 3-4)</td><td><code>-1</code></td>"
    assert page.repaired(table) == "<td>\u22121 (\u22122 to 3-4)</td><td><code>-1</code></td>"


@pytest.mark.parametrize(
    ("written", "printed"),
    [
        ("1.60e+04 (-3e-03 to 1e+05)", "16000 (\u22120.003 to 10\u2075)"),
        (
            "above 1e-08, 2.5e-12 Hz; 0e+00",
            "above 10\u207b\u2078, 2.5\u00b710\u207b\u00b9\u00b2 Hz; 0",
        ),
        ("a1e-05 1.2.3e+1 e+05", "a1e-05 1.2.3e+1 e+05"),
        ("&lt;= 3, &gt;= 1e-4", "\u2264 3, \u2265 10\u207b\u2074"),
    ],
)
def test_a_table_prints_powers_and_signs_and_code_keeps_them(written, printed):
    text = "<td>{0}</td><th>{0}</th><td><p>&gt; {0}<br />{0}</p></td>"
    assert page.repaired(text.format(written)) == text.format(printed)
    assert page.repaired(f"<td><code>{written}</code></td>") == f"<td><code>{written}</code></td>"


def test_figures_are_shown_at_one_scale_and_others_as_they_are(tmp_path):
    (tmp_path / "a.png").write_bytes(bytes(16) + (1000).to_bytes(4) + bytes(8))
    images = [nodes.image(uri="a.png", width="100%"), nodes.image(uri="b.svg")]
    page.natural_sizes(SimpleNamespace(srcdir=tmp_path), section(*images))
    assert [image.get("width") for image in images] == ["680px", None]


def test_a_page_whose_source_is_gone_goes_with_it(tmp_path):
    for name in ("a", "gone", "search", "_modules/b"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / f"{name}.html").touch()
    app = SimpleNamespace(outdir=tmp_path, env=SimpleNamespace(found_docs={"a"}))
    page.drop_old_pages(app, ValueError())
    assert (tmp_path / "gone.html").exists()
    page.drop_old_pages(app, None)
    left = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.html")}
    assert left == {"a.html", "search.html", "_modules/b.html"}


def test_a_column_with_phrases_is_marked_and_an_interval_may_go_below_its_value():
    table = (
        '<table class="results"><tr><td></td><th scope="col">n</th><th scope="col">why</th></tr>'
        '<tr><th scope="row">a b</th><td>1 (0 to 2)</td><td>bent &amp; late</td></tr></table>'
    )
    long = '<tr><th scope="row">a label of two lines</th><td>1</td></tr>'
    assert '<tr><th class="phrase" scope="row">a label' in page.repaired(
        f'<table class="results">{long}</table>'
    )
    table, written = table.replace("1 (0", "1 <wbr>(0"), table
    marked = table.replace("<td>bent", '<td class="phrase">bent')
    marked = marked.replace('<th scope="col">why', '<th class="phrase" scope="col">why')
    assert page.repaired(written) == marked
    numbers = written.replace("bent &amp; late", "yes")
    assert page.repaired(numbers) == table.replace("bent &amp; late", "yes")


def test_the_page_cites_the_book_as_its_citation_file_does():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf8"))
    text = (BOOK / "about.md").read_text(encoding="utf8")
    paper = citation["references"][0]
    for entry in (citation["title"], citation["version"], paper["title"], paper["doi"]):
        assert f"{{{entry}}}" in text
    authors = " and ".join(f"{a['family-names']}, {a['given-names']}" for a in paper["authors"])
    assert f"{{{authors}}}" in text


def glossary():
    def item(name, text):
        term = nodes.term("", name, ids=[f"term-{name}"])
        return nodes.definition_list_item("", term, nodes.definition("", paragraph(text)))

    return nodes.definition_list("", item("NIS", "A square. See."), item("gate", "A limit: far."))


def linked(*children):
    tree = section(*children)
    words.link_terms(tree, words.definitions(glossary()), "glossary.html")
    return [
        (link.astext(), link["refuri"], link["reftitle"]) for link in tree.findall(nodes.reference)
    ]


def test_the_first_appearance_of_a_term_leads_to_its_definition():
    text = paragraph("The gates and the gate of the NIS, no NISX, no sub-gate.")
    assert linked(text, paragraph("A gate.")) == [
        ("gates", "glossary.html#term-gate", "A limit"),
        ("NIS", "glossary.html#term-NIS", "A square."),
    ]
    assert text.astext() == "The gates and the gate of the NIS, no NISX, no sub-gate."


@pytest.mark.parametrize(
    "node",
    [
        nodes.title("", "A gate"),
        nodes.admonition("", paragraph("A gate")),
        nodes.paragraph("", "", nodes.reference("", "gate", refuri="a")),
        nodes.paragraph("", "", nodes.literal("", "gate")),
        paragraph("investigated, nis"),
    ],
)
def test_titles_boxes_links_and_code_have_no_such_link(node):
    tree = section(node)
    words.link_terms(tree, words.definitions(glossary()), "glossary.html")
    assert [r for r in tree.findall(nodes.reference) if "term" in r["classes"]] == []


def entry(kind, aliased=False):
    return SimpleNamespace(docname="reference/a", node_id="id", objtype=kind, aliased=aliased)


def test_names_that_are_public_and_unique_lead_to_the_reference():
    objects = {
        "d.ekf": entry("function"),
        "d.a.nis": entry("function"),
        "d.b.nis": entry("function"),
        "d.Track.x": entry("attribute"),
    }
    names = words.public(objects)
    assert names == {"ekf": ("reference/a", "id")}
    code = [nodes.literal("", text) for text in ("ekf", "ekf()", "nis", "x")]
    tree = section(
        nodes.paragraph("", "", *code), section(nodes.paragraph("", "", code[0].deepcopy()))
    )
    words.link_names(tree, names, lambda docname: f"{docname}.html")
    assert [r["refuri"] for r in tree.findall(nodes.reference)] == ["reference/a.html#id"] * 2


def test_every_formula_that_is_written_has_a_number_and_an_anchor():
    noted = []
    domain = SimpleNamespace(
        note_equation=lambda docname, label, location: noted.append(label),
        get_equation_number_for=noted.index,
    )
    document = new_document("a")
    document.settings.env = SimpleNamespace(
        docname="ekf", doc2path=lambda name: f"{name}.ipynb", get_domain=lambda name: domain
    )
    labeled = nodes.math_block("", "a", label="eq-a")
    printed = nodes.container("", nodes.math_block("", "b"), nb_element="cell_code_output")
    document += section(labeled, printed, nodes.math_block("", "c"))
    equations.NumberFormulas(document).apply()
    assert noted == ["ekf-2"]
    (target,) = document.findall(nodes.target)
    assert target["ids"] == ["equation-ekf-2"]
    assert target.next_node(siblings=True)["label"] == "ekf-2"


def luminance(color):
    parts = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    low, high = sorted([luminance(a), luminance(b)])
    return (high + 0.05) / (low + 0.05)


def test_contrast_is_that_of_wcag():
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.005)


@pytest.mark.parametrize("background", BACKGROUNDS)
def test_colored_words_have_the_contrast_that_wcag_asks_of_text(background):
    light = "".join(re.findall(r'^html\[data-theme="light"\][^}]*\}', STYLE, re.M))
    colors = re.findall(r"--pst-color-(?:success|warning|danger|link): (#\w{6})", light)
    assert len(colors) == 4
    assert min(contrast(color, BACKGROUNDS[background]) for color in colors) >= 4.5


def test_pages_of_source_share_navigation_by_their_depth():
    app, made = SimpleNamespace(_navigation={}), []

    def navigation(pagename, **options):
        context = {"toctree": lambda **options: made.append((pagename, options)) or len(made)}
        sooner.share_navigation(app, pagename, None, context, None)
        return context["toctree"](**options)

    deep, deeper = "_modules/dopplerlib/a", "_modules/dopplerlib/a/b"
    assert [navigation(page, depth=1) for page in (deep, deeper, deep, deeper)] == [1, 2, 1, 2]
    assert navigation("_modules/dopplerlib/c", depth=1) == 1
    assert navigation("_modules/dopplerlib/c", depth=2) == 3
    assert [navigation("tour", depth=1) for _ in range(2)] == [4, 5]

"""A page of the built book can link to a cell by its id."""

import importlib.util
from pathlib import Path
from types import SimpleNamespace

import nbformat
import pytest
from docutils import nodes

BOOK = Path(__file__).resolve().parents[2] / "book"


@pytest.fixture
def extension():
    spec = importlib.util.spec_from_file_location("cell_anchors", BOOK / "_ext/cell_anchors.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def app_for(path):
    env = SimpleNamespace(docname="page", doc2path=lambda _: str(path))
    return SimpleNamespace(env=env)


def test_code_cells_get_their_ids_and_nothing_else_does(extension, tmp_path):
    path = tmp_path / "page.ipynb"
    cells = [
        nbformat.v4.new_markdown_cell("text", id="words"),
        nbformat.v4.new_code_cell("1", id="one"),
    ]
    nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
    code = nodes.container(nb_element="cell_code", cell_index=1)
    output = nodes.container(nb_element="cell_code_output")
    tree = nodes.container("", code, output)
    extension._add_anchors(app_for(path), tree)
    assert code["ids"] == ["cell-one"]
    assert output["ids"] == tree["ids"] == []


def test_a_page_that_is_no_notebook_is_left_alone(extension, tmp_path):
    code = nodes.container(nb_element="cell_code", cell_index=0)
    extension._add_anchors(app_for(tmp_path / "page.md"), nodes.container("", code))
    assert code["ids"] == []


def test_a_link_to_a_cell_names_the_chapter_not_its_file(extension):
    titles = {"asheim_two": nodes.title("", "Two radars"), "harvest": nodes.title("", "A & B")}
    env = SimpleNamespace(titles=titles, toc_secnumbers={"asheim_two": {"": (18,)}})
    links = (
        '<a href="asheim_two.html#cell-area">asheim two</a>',
        '<a href="asheim_two.html#cell-judged">number</a>',
        '<a href="harvest.html#cell-one">harvest</a>',
    )
    context = {"body": " ".join(links)}
    extension._name_chapters(SimpleNamespace(env=env), "page", "", context, None)
    assert context["body"] == " ".join(
        (
            '<a href="asheim_two.html#cell-area" title="Two radars">chapter 18</a>',
            '<a href="asheim_two.html#cell-judged" title="Two radars">number</a>',
            '<a href="harvest.html#cell-one" title="A &amp; B">A &amp; B</a>',
        )
    )

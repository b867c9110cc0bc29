"""The tool that executes chapters must notice every change, and never lose a file."""

import json
import os

import nbformat
import pytest

from tools import isolation, notebooks

FIGURE = "from IPython.display import display\n\ndisplay({'image/png': 'iVBO'}, raw=True)"


@pytest.fixture
def chapter(tmp_path):
    """Return a function that writes a notebook of some cells and returns its path."""

    def write(*sources):
        cells = [nbformat.v4.new_code_cell(s, id=f"c{i}") for i, s in enumerate(sources)]
        path = tmp_path / "chapter.ipynb"
        nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
        return path

    return write


def tamper(path, change):
    content = json.loads(path.read_text(encoding="utf8"))
    change(content["cells"])
    path.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf8")


def test_an_executed_chapter_passes_the_check_unchanged(chapter, capsys):
    path = chapter("a = 6", "print(7 * a)", FIGURE)
    assert notebooks.main([str(path)]) == 0
    first = path.read_bytes()
    assert b'"42\\n"' in first
    assert "```text\n42\n```" in (path.parent / "text" / "chapter.md").read_text(encoding="utf8")
    assert notebooks.main(["--check", str(path)]) == 0  # executed again, it is the same text
    assert capsys.readouterr().out == ""
    assert path.read_bytes() == first


def test_the_check_tells_text_from_images_and_writes_nothing(chapter, capsys):
    path = chapter("print(42)", "'same'", FIGURE)
    notebooks.main([str(path)])

    def change(cells):
        cells[0]["outputs"][0]["text"] = ["43\n"]
        cells[1]["execution_count"] = None
        cells[2]["outputs"][0]["data"]["image/png"] = "AAAA"

    tamper(path, change)
    tampered = path.read_bytes()
    assert notebooks.main(["--check", str(path)]) == 1
    assert [line.partition(": ")[2] for line in capsys.readouterr().out.splitlines()] == [
        "cell 0 (c0): text of the output differs",
        "cell 1 (c1): was not executed",
        "cell 2 (c2): image only",
    ]
    assert path.read_bytes() == tampered


@pytest.mark.parametrize("last", ["1 / 0", "import sys\n\nprint('careful', file=sys.stderr)"])
def test_a_failing_chapter_keeps_its_file(chapter, capsys, last):
    path = chapter("print(42)", last)
    before = path.read_bytes()
    assert notebooks.main([str(path)]) == 1
    assert path.read_bytes() == before
    assert list(path.parent.iterdir()) == [path]
    assert "ZeroDivisionError" in (err := capsys.readouterr().err) or "careful" in err


def test_cells_without_an_id_get_the_same_one_every_time(chapter):
    path = chapter("1", "2", "3")

    def forget(cells):
        del cells[0]["id"], cells[2]["id"]
        cells[1]["id"] = "cell-02"

    tamper(path, forget)
    for _ in range(2):
        assert [c.id for c in notebooks.read(path).cells] == ["cell-00", "cell-02", "cell-02-1"]


def test_copies_of_a_chapter_are_no_chapters(tmp_path):
    for name in ["a.ipynb", "part/b.ipynb", "_build/a.ipynb", ".ipynb_checkpoints/a.ipynb"]:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    assert notebooks.chapters(tmp_path) == [tmp_path / "a.ipynb", tmp_path / "part" / "b.ipynb"]


def test_a_chapter_needs_no_home_and_takes_nothing_from_it(chapter, monkeypatch, tmp_path):
    for name in (*isolation.PROFILE, "MPLCONFIGDIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", "/dev/null")
    before = dict(os.environ)
    path = chapter("import matplotlib\n\nprint(matplotlib.get_configdir() != '/dev/null')")
    assert notebooks.main([str(path)]) == 0
    assert "True" in path.read_text(encoding="utf8")
    assert dict(os.environ) == before


def test_a_chapter_that_may_not_be_written_is_refused_before_it_is_executed(chapter, monkeypatch):
    path = chapter("print(42)")
    path.chmod(0o444)
    monkeypatch.setattr(notebooks, "execute", None)
    with pytest.raises(SystemExit, match=r"error: path .* may be written to, got .*chapter\.ipynb"):
        notebooks.main([str(path)])

"""The page on reproducibility tells the hashes of what is stored, and forgets nothing."""

import json
import re

import pytest
import yaml

from dopplerlib.replication.documents import documents
from tools import record
from tools.notebooks import ROOT

PAGE = record.PAGE.read_text(encoding="utf8")


def test_the_hashes_on_the_page_are_those_of_the_stored_results_and_data():
    """If this fails: `make chapter NAME=...`; for data alone, `python -m tools.record --hashes`."""
    for table in record.hash_tables():
        assert table in PAGE


def test_every_document_has_its_verdicts():
    """If this fails: `make record NAME=...`."""
    _, tried = record.recorded(PAGE)
    judged = [
        name for name, rows in tried.items() if (*(row[0] for row in rows),) == record.SEEDS_TRIED
    ]
    assert judged == list(documents())


def test_a_changed_result_changes_its_hash_and_a_changed_text_does_not(tmp_path):
    cells = [{"cell_type": "code", "source": "1", "outputs": [{"text": "1"}]}]
    path = tmp_path / "chapter.ipynb"
    hashes = []
    for key, value in (("source", "1"), ("source", "1  # one"), ("outputs", [{"text": "2"}])):
        cells[0][key] = value
        path.write_text(json.dumps({"cells": cells}), encoding="utf8")
        hashes.append(record.digest(record.results(path)))
    assert hashes[0] == hashes[1] != hashes[2]


def test_seeds_are_found_in_code_only(tmp_path):
    cells = [
        {"cell_type": "code", "source": ["rng = np.random.default_rng(12)\n", "default_rng(3)"]},
        {"cell_type": "markdown", "source": "default_rng(99)"},
    ]
    path = tmp_path / "chapter.ipynb"
    path.write_text(json.dumps({"cells": cells}), encoding="utf8")
    assert record.seeds(path) == [3, 12]


@pytest.mark.parametrize(("repeated", "tried"), [(False, "fine"), (True, None)])
def test_nothing_is_written_if_a_result_differs(monkeypatch, tmp_path, repeated, tried):
    monkeypatch.setattr(record, "PAGE", tmp_path / "page.md")
    monkeypatch.setattr(record, "chapters_repeat", lambda: repeated)
    monkeypatch.setattr(record, "seeds_tried", lambda names: tried)
    assert record.main([]) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("there", "other"),
    [("typical", "none"), ("undecided", "a"), ("contradicted", None)],
)
def test_a_seed_may_leave_a_verdict_undecided_and_must_not_turn_it(monkeypatch, there, other):
    judgments = {"a": there, "b": "reproduced"}
    found = {"paper": dict.fromkeys(record.SEEDS_TRIED, judgments)}
    monkeypatch.setattr(record.judged, "verdicts_by_seed", lambda names, seeds: found)
    monkeypatch.setattr(record.judged, "on_record", lambda name: judgments | {"a": "typical"})
    tried = record.seeds_tried(["paper"])
    assert (tried and {row[-1] for row in tried["paper"]}) == (other and {other})


def test_one_document_is_judged_alone_and_the_others_keep_their_rows(monkeypatch, tmp_path):
    ran, tried = record.recorded(PAGE)
    assert record.page(ran, tried) == PAGE
    first, *others = tried
    path = tmp_path / "page.md"
    path.write_text(record.page(ran, {name: tried[name] for name in others}), encoding="utf8")
    monkeypatch.setattr(record, "PAGE", path)
    monkeypatch.setattr(record, "seeds_tried", lambda names: {name: tried[name] for name in names})
    monkeypatch.setattr(record, "chapters_repeat", None)
    assert record.main([first]) == 0
    assert path.read_text(encoding="utf8") == PAGE


def test_fresh_hashes_keep_what_was_measured(monkeypatch, tmp_path):
    path = tmp_path / "page.md"
    measured = "here", record.recorded(PAGE)[1]
    path.write_text(record.page(*measured).replace("`codecheck.yml`", "it"), encoding="utf8")
    monkeypatch.setattr(record, "PAGE", path)
    assert record.main(["--hashes"]) == 0
    assert path.read_text(encoding="utf8") == record.page(*measured)


def test_the_versions_are_those_of_the_lock():
    lock = (ROOT / "environment.lock").read_text(encoding="utf8")
    for name, version in record.packages().items():
        assert re.search(rf"^{name}=={re.escape(version)}\b", lock, flags=re.MULTILINE), name


@pytest.fixture(scope="module")
def manifest():
    text = (ROOT / "codecheck.yml").read_text(encoding="utf8")
    assert text.startswith("---\n")
    return yaml.safe_load(text)


def test_the_manifest_names_files_that_are_there(manifest):
    for item in manifest["manifest"]:
        assert (ROOT / item["file"]).is_file()
        assert item["comment"]


def test_the_manifest_covers_every_figure_and_table_of_the_paper_that_holds_results(manifest):
    comments = " ".join(item["comment"] for item in manifest["manifest"])
    for part in ("Fig 1", "Fig 3", "Fig 4", "Fig 5", "Fig 6", "Table 2"):
        assert part in comments


def test_the_manifest_cites_the_paper_as_the_citation_file_does(manifest):
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf8"))
    (paper,) = citation["references"]
    assert manifest["paper"]["title"] == paper["title"]
    assert manifest["paper"]["reference"].endswith(paper["doi"])
    assert [author["name"] for author in manifest["paper"]["authors"]] == [
        f"{author['given-names']} {author['family-names']}" for author in paper["authors"]
    ]

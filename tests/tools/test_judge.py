"""The tool that judges with several seeds must notice a verdict that depends on the draw."""

from tools import judge

RECORD = {"paper": {"a": "typical", "b": "reproduced"}}


def test_equal_verdicts_are_no_difference():
    found = {"paper": {1: dict(RECORD["paper"]), 2: dict(RECORD["paper"])}}
    assert judge.differences(found, RECORD) == []


def test_a_verdict_that_differs_is_named_with_document_seed_and_both_verdicts():
    found = {"paper": {1: dict(RECORD["paper"]), 2: {"a": "atypical", "b": "reproduced"}}}
    assert judge.differences(found, RECORD) == ["paper, seed 2: a is atypical, on record typical"]


def test_a_claim_that_is_missing_is_a_difference():
    assert len(judge.differences({"paper": {1: {"a": "typical"}}}, RECORD)) == 1
    assert len(judge.differences({"paper": {1: RECORD["paper"] | {"c": "typical"}}}, RECORD)) == 1


def test_the_table_counts_verdicts_for_each_document_and_seed():
    head, first, second = judge.table({"paper": {1: RECORD["paper"], 20: RECORD["paper"]}})
    assert head.split() == ["document", "seed", *judge.VERDICTS]
    assert first.split() == ["paper", "1", "1", "1", *["0"] * (len(judge.VERDICTS) - 2)]
    assert second.split()[:2] == ["paper", "20"]
    assert len({len(head), len(first), len(second)}) == 1


def test_the_exit_code_tells_whether_verdicts_differ(monkeypatch, capsys):
    monkeypatch.setattr(judge, "on_record", RECORD.get)
    monkeypatch.setattr(judge, "verdicts", lambda document, seed: RECORD[document])
    assert judge.main(["paper", "--seeds", "1", "2", "3", "--workers", "1"]) == 0
    monkeypatch.setattr(
        judge,
        "verdicts",
        lambda document, seed: (
            RECORD[document] | {"a": "atypical"} if seed == 3 else RECORD[document]
        ),
    )
    assert judge.main(["paper", "--seeds", "1", "2", "3", "--workers", "1"]) == 1
    out = capsys.readouterr()
    assert "seed 3: a is atypical" in out.out
    assert "3 of 3: paper, seed 3" in out.err

"""Documents are found by their names, and what is none is refused."""

import pytest

from dopplerlib.replication.documents import data_file, documents


def test_every_folder_with_claims_is_a_document():
    assert len(documents()) >= 5
    assert all(data_file(name, "claims.toml").is_file() for name in documents())


def test_what_is_no_document_or_no_file_is_refused():
    with pytest.raises(ValueError, match=r"document must be one of 'asheim2015', .*, got 'asheim'"):
        data_file("asheim", "claims.toml")
    with pytest.raises(ValueError, match=r"name must be one of 'README.md', .*, got '../claims.t"):
        data_file("valarmathi", "../claims.toml")

"""Numeric code printed by `dopplerlib.derive`: readable, committed, never edited by hand."""

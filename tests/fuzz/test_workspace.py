"""Odd arguments of every public function of `dopplerlib.workspace`."""

from tests.fuzz.check import of_package

test_odd_arguments = of_package("workspace")

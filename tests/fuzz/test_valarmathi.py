"""Odd arguments of every public function of `dopplerlib.systems.valarmathi`."""

from tests.fuzz.check import of_package

test_odd_arguments = of_package("systems.valarmathi")

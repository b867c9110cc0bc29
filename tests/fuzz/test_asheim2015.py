"""Odd arguments of every public function of `dopplerlib.systems.asheim2015`."""

from tests.fuzz.check import of_package

test_odd_arguments = of_package("systems.asheim2015")

"""Odd arguments of every public function of `dopplerlib.systems.mittermaier2016`."""

from tests.fuzz.check import of_package

test_odd_arguments = of_package("systems.mittermaier2016")

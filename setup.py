"""The wheel carries `data/` and `results/` in the package; all else stands in pyproject.toml."""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["dopplerlib*"]), "dopplerlib.data", "dopplerlib.results"],
    package_dir={"dopplerlib.data": "data", "dopplerlib.results": "results"},
    package_data={
        "": ["*.mplstyle", "*.pyi", "py.typed"],
        "dopplerlib.data": ["**"],
        "dopplerlib.results": ["**"],
    },
)

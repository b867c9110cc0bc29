"""The wheel carries `data/` inside the package; all else stands in pyproject.toml."""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["dopplerlib*"]), "dopplerlib.data"],
    package_dir={"dopplerlib.data": "data"},
    package_data={"": ["*.html", "*.mplstyle", "*.pyi", "py.typed"], "dopplerlib.data": ["**"]},
)

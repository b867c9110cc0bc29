"""The writer of whole files, by the name that tools and scripts have for it."""

from dopplerlib._files import write_text as write

__all__ = ["write"]

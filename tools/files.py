"""The writer of whole files, by the name that scripts outside the checkout have for it."""

from dopplerlib._files import write_text as write

__all__ = ["write"]

"""Write a file whole or not at all."""

from dopplerlib._files import write_text as write

__all__ = ["write"]

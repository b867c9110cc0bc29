"""What the documented type of an argument rules out, whatever the function does."""

NOT_NUMBERS = {
    "text", "texts", "bytes", "date", "object", "container", "callable", "masked", "unit", "ragged",
    "path", "other number",
}  # fmt: skip
NUMBERS = {"number", "complex", "bool", "date", "other number", "array", "masked", "unit"}


def refused(kind, nature, optional):
    """Return whether an argument of the type `kind` must not take a value of a nature.

    `kind` is what stands behind the colon in a numpydoc section; `optional` says that None is the
    default. A type of several words with "or" between them is left to the function.
    """
    if nature == "none":
        return not (optional or "None" in kind or "optional" in kind)
    if nature == "same":
        return False
    if kind.startswith(("float or array_like", "complex or array_like", "float or None")):
        kind = kind.replace(" or ", ", ")
    if " or " in kind:
        return False
    if kind.startswith(("array_like", "float", "complex", "int", "pair of array_like")):
        allowed = {word for word in ("bool", "complex") if word in kind}
        return nature in (NOT_NUMBERS | {"bool", "complex"}) - allowed
    if kind.startswith("numpy.random.Generator"):
        return True
    if kind.startswith("bool"):
        return nature in (NOT_NUMBERS | NUMBERS) - {"bool"}
    if kind.startswith(("{", "str")):
        return nature in (NOT_NUMBERS | NUMBERS) - {"text", "path"}
    if kind.startswith("path-like"):
        return nature in (NOT_NUMBERS | NUMBERS) - {"text", "path", "bytes"}
    if kind.startswith("callable"):
        return nature in (NOT_NUMBERS | NUMBERS) - {"callable", "object"}
    if kind.startswith("sympy."):
        return nature in NOT_NUMBERS | NUMBERS
    return kind[0].isupper() and nature in NOT_NUMBERS | NUMBERS

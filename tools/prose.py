"""The chapters as text that can be reviewed: a changed sentence is a changed line.

A stored notebook holds pictures, so its differences are unreadable. Beside it `book/text` holds the
same chapter as a reviewer reads it: prose, code and printed results.
"""

import re

# A line that begins so is laid out by its author: headings, tables, directives, quotes, labels,
# formulas, comments, HTML, code.
_LAID_OUT = re.compile(r"\s*(#|\||:|`{3}|\$\$|>|\([\w-]+\)=|%|\+\+\+|<|\\|\{|\[\^| {4})")
_ITEM = re.compile(r"(\s*(?:[-*+]|\d+\.)\s+)")
# The end of a sentence: what closes with it, then white space, then what a sentence begins with.
_END = re.compile(r"(?<=[.!?])([\"')\]*_]*)\s+(?=[\"'(\[*_]*[A-ZÀ-ÖØ-Þ0-9$`{])")
_ABBREVIATED = re.compile(
    r"(\b(?:e\.g|i\.e|cf|vs|al|Fig|Figs|Eq|Eqs|Sec|Dr|St|No|[A-Z])\.|^\d+\.)$"
)
_WHOLE = re.compile(r"`+[^`]*`+|\$[^$]*\$|\{[\w:-]+\}|\[[^\]]*\]\([^)]*\)")


def sentences(markdown):
    """Return Markdown with one sentence a line; what is laid out by hand stays as it is."""
    done, block, fence = [], [], None
    for line in [*markdown.split("\n"), ""]:
        mark = re.match(r"\s*(`{3,}|\$\$)", line)
        if fence is None and mark and not (mark[1] == "$$" and line.count("$$") > 1):
            fence = mark[1]
        elif fence is not None:
            fence = None if line.strip().startswith(fence) or line.endswith("$$") else fence
            done.append(line)
            continue
        if fence is not None or not line.strip() or _LAID_OUT.match(line):
            done += [*_broken(block), line]
            block = []
        elif _ITEM.match(line):
            done += _broken(block)
            block = [line]
        else:
            block.append(line)
    return "\n".join(done[:-1])


def _broken(block):
    """Return the lines of a paragraph or a list's item, one for each sentence."""
    if not block:
        return []
    if any(line.endswith(("\\", "  ")) for line in block):  # a line break that is meant
        return block
    item = _ITEM.match(block[0])
    first = item[1] if item else re.match(r"\s*", block[0])[0]
    text = " ".join([block[0][len(first) :], *block[1:]])
    text = re.sub(r"\s+", " ", text).strip()
    whole = _WHOLE.findall(text)
    masked = _WHOLE.sub("\x00", text)
    parts, rest = [""], _END.split(masked)
    for piece, closing in zip(rest[::2], [*rest[1::2], ""], strict=True):
        joined = f"{parts[-1]} {piece}{closing}" if parts[-1] else piece + closing
        parts[-1] = joined
        if not _ABBREVIATED.search(joined):
            parts.append("")
    pieces = iter(whole)
    parts = [re.sub("\x00", lambda _: next(pieces), part) for part in parts if part]
    # A sentence must not begin a line as something else would: a list, a heading, a table.
    lines = [first + parts[0]]
    for part in parts[1:]:
        if _LAID_OUT.match(part) or _ITEM.match(part):
            lines[-1] += f" {part}"
        else:
            lines.append(" " * len(first) + part)
    return lines


def text_path(chapter):
    """Return where the text of a chapter stands."""
    return chapter.parent / "text" / f"{chapter.stem}.md"


def as_text(notebook):
    """Return a chapter as text: its prose, its code, and what the code printed."""
    blocks = []
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] != "code":
            blocks.append(sentences(source))
            continue
        blocks.append(f"```python\n# cell {cell['id']}\n{source}\n```")
        shown = "\n".join(filter(None, map(_shown, cell["outputs"])))
        if shown:
            blocks.append(f"```text\n{shown}\n```")
    return "\n\n".join(block.rstrip() for block in blocks) + "\n"


def _shown(output):
    """Return the text of an output; of a picture nothing."""
    data = output.get("data", {})
    if any(kind.startswith("image/") for kind in data):
        return ""
    text = output.get("text", data.get("text/markdown", data.get("text/plain", "")))
    return "".join(text).rstrip()

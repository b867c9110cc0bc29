"""Leave out of the theme's icons all that no page shows: 1.4 MB, which every page would load.

The theme's file holds two thousand icons, each an entry ``name:[width,height,[aliases],code,path]``
of an object in JavaScript. Reading it took a quarter of the time in which a page opens.
"""

import re
from pathlib import Path

from sphinx.errors import ExtensionError

ENTRY = re.compile(r'"?([\w-]+)"?:\[\d+,\d+,\[([^\]]*)\],"[0-9a-f]+",(?:"[^"]*"|\[[^\]]*\])\],?')
SHOWN = re.compile(r"\bfa-([a-z0-9-]+)")


def leave_out(text, shown):
    """Return the text of the theme's file with the entries of these names only."""

    def kept(entry):
        return entry[0] if shown & {entry[1], *re.findall(r"[\w-]+", entry[2])} else ""

    return ENTRY.sub(kept, text)


def icons(app, exception):
    """Write the theme's file anew, with what pages and other scripts ask for."""
    if exception or app.builder.format != "html":
        return
    out = Path(app.outdir)
    file = out / "_static" / "scripts" / "fontawesome.js"
    asking = [*out.rglob("*.html"), *out.glob("_static/**/*.js")]
    texts = (path.read_text(encoding="utf8") for path in asking if path != file)
    shown = {name for text in texts for name in SHOWN.findall(text)}
    whole = file.read_text(encoding="utf8")
    if not ENTRY.search(whole):
        raise ExtensionError(f"{file.name} has no icon: its theme has another form now")
    file.write_text(leave_out(whole, shown), encoding="utf8")


def setup(app):
    """Register the extension with Sphinx."""
    app.connect("build-finished", icons)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

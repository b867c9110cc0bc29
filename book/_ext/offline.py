"""Serve MathJax from the book itself; refuse a page that would load anything from elsewhere."""

import re
from html.parser import HTMLParser
from importlib.metadata import files
from pathlib import Path

from sphinx.errors import ExtensionError
from sphinx.util.fileutil import copy_asset_file

BUNDLE = "tex-svg-full.js"  # one file: every TeX extension, glyphs as SVG paths, no web font
LOADING_LINKS = {"stylesheet", "icon", "preload", "prefetch", "modulepreload", "preconnect"}
REMOTE = re.compile(r"\s*(?:(?:https?|wss?|ftp):)?//", re.I)
# Tags that load nothing make up most of a page; without them the parser is seven times faster.
HARMLESS = re.compile(
    r"</?(?:a|code|dd|div|dl|dt|em|li|p|span|td|tr|ul)"
    r'(?: (?:class|href|id|rel|role|title)="[^"]*")*>'
)
REMOTE_CSS = re.compile(r"(?:url\(\s*|@import\s+)[\"']?((?:https?:)?//[^\"')\s;]+)", re.I)


class _Assets(HTMLParser):
    """Collects the remote addresses that a browser fetches without being asked."""

    def __init__(self):
        super().__init__()
        self.remote = []
        self._in_style = False

    def handle_starttag(self, tag, attrs):
        attrs = {name: value or "" for name, value in attrs}
        self._in_style = tag == "style"
        addresses = [attrs.get("src", ""), attrs.get("poster", ""), attrs.get("data", "")]
        addresses += attrs.get("srcset", "").split(",")
        if tag == "link" and LOADING_LINKS & set(attrs.get("rel", "").lower().split()):
            addresses.append(attrs.get("href", ""))
        if tag in {"image", "use"}:  # inside an inline SVG
            addresses += [attrs.get("href", ""), attrs.get("xlink:href", "")]
        self.remote += [address.strip() for address in addresses if REMOTE.match(address)]
        self.remote += REMOTE_CSS.findall(attrs.get("style", ""))

    def handle_endtag(self, tag):
        self._in_style = False

    def handle_data(self, data):
        if self._in_style:
            self.remote += REMOTE_CSS.findall(data)


def remote_assets(text, suffix=".html"):
    """Return the remote addresses that the text of a page or of a style sheet would load."""
    if suffix == ".css":
        return REMOTE_CSS.findall(text)
    parser = _Assets()
    parser.feed(HARMLESS.sub("", text))
    parser.close()
    return parser.remote


def copy_mathjax(app):
    """Copy the one file that the pages need; the package holds ten times as much."""
    source = next(f for f in files("sphinx-mathjax-offline") if f.match(f"mathjax/{BUNDLE}"))
    target = Path(app.outdir, "_static", "mathjax")
    target.mkdir(parents=True, exist_ok=True)
    copy_asset_file(str(source.locate()), str(target))
    return []


def refuse_remote(app, exception):
    """Fail the build when a page or a style sheet loads something from elsewhere."""
    if exception or app.builder.format != "html":
        return
    out = Path(app.outdir)
    found = [
        f"{path.relative_to(out)}: {address}"
        for path in sorted(out.rglob("*"))
        if path.suffix in {".html", ".css"}
        for address in remote_assets(path.read_text(encoding="utf8"), path.suffix)
    ]
    if found:
        raise ExtensionError("\n".join(["remote assets:", *found]))


def setup(app):
    app.config.mathjax_path = f"mathjax/{BUNDLE}"
    app.connect("html-collect-pages", copy_mathjax)
    app.connect("build-finished", refuse_remote)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

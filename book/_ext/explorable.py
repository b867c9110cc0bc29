"""The directive ``{explorable}``: a figure that its reader moves.

Its still picture is part of the page, so paper and a browser without JavaScript show it; the
scripts, which lie in `_explorables`, take it over.
"""

from html import escape
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective
from sphinx.util.fileutil import copy_asset_file
from tools import explorables


class Explorable(SphinxDirective):
    """A figure: name of the explorable, ``alt`` of the still picture, and the caption."""

    required_arguments = 1
    has_content = True
    option_spec = dict.fromkeys(("alt", "name"), directives.unchanged_required)

    def run(self):
        """Return the figure; the first one of a page brings what all share."""
        name = self.arguments[0]
        if name not in explorables.SETTINGS or not {"alt", "name"} <= self.options.keys():
            raise self.error("an explorable must be known, and have a name and an alt")
        picture = explorables.FOLDER.joinpath(f"{name}.svg").read_text(encoding="utf-8").strip()
        role = f'<svg role="img" aria-label="{escape(self.options["alt"])}"'
        loaded = self.env.temp_data.setdefault("explorables", [])
        wanted = [script for script in explorables.scripts(name) if script not in loaded]
        loaded += wanted
        home = "../" * self.env.docname.count("/") + "_static/explorables/"
        tags = "".join(f'<script defer src="{home}{script}"></script>' for script in wanted)
        html = (
            f'<div class="explorable" data-explorable="{name}">{picture.replace("<svg", role, 1)}'
            f'<script type="application/json">{explorables.settings(name)}</script></div>{tags}'
        )
        figure = nodes.figure("", nodes.raw("", html, format="html"))
        self.set_source_info(figure)
        self.add_name(figure)
        caption, messages = self.parse_inline(" ".join(self.content), lineno=self.lineno)
        figure += nodes.caption("", "", *caption)
        return [figure, *messages]


def copy_scripts(app):
    """Copy the scripts, which only pages with explorables load."""
    target = Path(app.outdir, "_static", "explorables")
    target.mkdir(parents=True, exist_ok=True)
    for path in sorted(explorables.FOLDER.glob("*.js")):
        copy_asset_file(str(path), str(target))
    return []


def setup(app):
    """Register the extension with Sphinx."""
    app.add_directive("explorable", Explorable)
    app.connect("html-collect-pages", copy_scripts)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

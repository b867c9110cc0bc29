"""Give code cells anchors made of their ids, and name the chapter that a link to one leads to.

A table of verdicts knows the file of a chapter only: its number is known when the book is built.
"""

import re
from html import escape

import nbformat
from docutils import nodes

LINK = re.compile(r'<a href="(\w+)\.html#cell-([\w-]+)">([^<]+)</a>')


def setup(app):
    """Register the extension with Sphinx."""
    app.connect("doctree-read", _add_anchors)
    app.connect("html-page-context", _name_chapters)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _add_anchors(app, doctree):
    path = app.env.doc2path(app.env.docname)
    if not path.endswith(".ipynb"):
        return
    cells = nbformat.read(path, as_version=4).cells
    for node in doctree.findall(nodes.container):
        if node.get("nb_element") == "cell_code":
            node["ids"].append(f"cell-{cells[node['cell_index']].id}")


def _name_chapters(app, pagename, template, context, doctree):
    if "body" in context:
        context["body"] = LINK.sub(lambda link: _named(app.env, *link.groups()), context["body"])


def _named(env, page, cell, words):
    title = env.titles[page].astext() if page in env.titles else page
    if words == page.replace("_", " "):
        number = env.toc_secnumbers.get(page, {}).get("")
        words = f"chapter {number[0]}" if number else title
    return f'<a href="{page}.html#cell-{cell}" title="{escape(title)}">{escape(words)}</a>'

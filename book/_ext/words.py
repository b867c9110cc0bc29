"""Lead from a word to its definition: terms to the glossary, names in code type to the reference.

On each page the first appearance of a term of the glossary in a paragraph becomes a link, whose
title is the beginning of its definition; in each section the first appearance of a public name
does. So no author has to remember, and a new term or function is linked on all pages.
"""

import re

from docutils import nodes

GLOSSARY = "glossary"
NAMES = ("function", "class", "exception")
# Short words of everyday English, which a paragraph uses in their everyday sense, too.
EVERYDAY = {"lead", "claim", "choice", "premise", "interpretation", "link", "window", "ridge"}
NOT_THERE = (nodes.reference, nodes.title, nodes.caption, nodes.Admonition, nodes.table)
LONGEST = 160  # characters of a title


def definitions(glossary):
    """Return, by term, the id and the first sentence of its definition."""
    found = {}
    for item in glossary.findall(nodes.definition_list_item):
        text = item.next_node(nodes.definition).next_node(nodes.paragraph).astext()
        text = " ".join(text.replace("\\", "").split())  # a title shows no formula
        sentence = re.split(r"(?<=[.:]) ", text)[0].rstrip(":")
        for term in item.findall(nodes.term):
            if term["ids"]:
                found[term.astext()] = term["ids"][0], sentence[:LONGEST]
    return found


def pattern(terms):
    """Return the expression that finds any of the terms, the longest first, plurals too."""
    words = sorted((term for term in terms if term not in EVERYDAY), key=len, reverse=True)
    alternatives = "|".join(re.escape(word).replace(r"\ ", r"\s+") for word in words)
    return re.compile(rf"(?<![\w-])({alternatives})s?(?![\w-])", re.IGNORECASE)


def link_terms(doctree, found, uri):
    """Make links of the first appearance of each term in the paragraphs of a page."""
    known = {term.lower(): term for term in found}
    expression, done = pattern(found), set()
    for text in list(doctree.findall(nodes.Text)):
        if not isinstance(text.parent, nodes.paragraph) or _inside(text, NOT_THERE):
            continue
        pieces, end = [], 0
        for match in expression.finditer(text):
            term = known[re.sub(r"\s+", " ", match[1]).lower()]
            if term in done or (term.isupper() and not match[1].isupper()):
                continue
            done.add(term)
            target, title = found[term]
            link = nodes.reference("", match[0], refuri=f"{uri}#{target}", internal=True)
            link["reftitle"] = title
            link["classes"] += ["term"]
            pieces += [nodes.Text(text[end : match.start()]), link]
            end = match.end()
        if pieces:
            text.parent.replace(text, [*pieces, nodes.Text(text[end:])])


def public(objects):
    """Return, by its last part, the page and the anchor of each name that only one object has."""
    found = {}
    for name, entry in objects.items():
        if entry.objtype in NAMES and not entry.aliased:
            found.setdefault(name.rpartition(".")[2], []).append((entry.docname, entry.node_id))
    return {name: places[0] for name, places in found.items() if len(places) == 1}


def link_names(doctree, found, uri):
    """Make links of the first appearance of each public name in the text of each section."""
    done = set()
    for literal in list(doctree.findall(nodes.literal)):
        name = literal.astext().removesuffix("()")
        section = _inside(literal, nodes.section)
        if name not in found or (section, name) in done or _inside(literal, NOT_THERE[:3]):
            continue
        done.add((section, name))
        page, anchor = found[name]
        link = nodes.reference("", "", refuri=f"{uri(page)}#{anchor}", internal=True)
        literal.replace_self(link)
        link += literal


def _inside(node, kinds):
    while node is not None and not isinstance(node, kinds):
        node = node.parent
    return node


def link(app, doctree, docname):
    """Do both on a page; the glossary links to itself by hand, the reference by its own roles."""
    if app.builder.format != "html" or docname.startswith("reference/"):
        return
    env = app.env
    names = public(env.get_domain("py").objects)
    link_names(doctree, names, lambda page: app.builder.get_relative_uri(docname, page))
    if GLOSSARY in env.all_docs and docname != GLOSSARY:
        if not hasattr(app, "_terms"):
            app._terms = definitions(env.get_doctree(GLOSSARY))
        link_terms(doctree, app._terms, app.builder.get_relative_uri(docname, GLOSSARY))


def setup(app):
    """Register the extension with Sphinx."""
    app.connect("doctree-resolved", link)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

"""What a page has around its text: description and picture for search engines and messages, ids.

Also repairs of what stands below: an id that every exercise has again, heads of columns that are
empty, roles of the bibliography that no screen reader understands; columns of words, which wrap and
begin at the left, while those of numbers do neither, but for an interval: in a wide table it stands
below its value. Powers of ten are printed as such, not as a program writes them.
"""

import re
from decimal import Decimal
from html import escape, unescape
from itertools import count
from pathlib import Path

from docutils import nodes

PICTURE = "hero.png"  # in `_static`: a hundred tracks, as the first page has them
SCALE = 0.68  # px of a page for one of a figure: seven inches are as wide as the text
LONGEST = 200  # characters of a description: what a search engine shows
FORMULA = "\N{OBJECT REPLACEMENT CHARACTER}"  # which no search engine can show
# "An estimate x of the state" can be read without x; "errors of x, y and z" or "x is small" cannot.
NEEDED = re.compile(rf"^{FORMULA}|{FORMULA}(?:\W*$|[^\w\s]| (?:and|or|is|are|has|have)\b)")
END = r"(?<! al)[.!?](?=\s|$)"  # of a sentence, but for "et al."
SENTENCE = re.compile(rf".+?(?:{END}|$)")
REPEATED = {"exercise-content", "solution-content"}
CITE = {
    "type": "link",
    "tooltip": "Cite this book",
    "icon": "fas fa-quote-right",
    "label": "cite-button",
}
EMPTY_HEAD = re.compile(r"<th[^>]*>\s*(?:<p>\s*</p>)?\s*</th>")
CELL = re.compile(r"(?<=>)[^<>]+(?=</t[dh]>|</p>\s*</td>|<br)")  # lines of a table
POWER = re.compile(r"(?<![\w.])(\d(?:\.\d+)?)e([+-]\d+)(?!\w)")
SIGNS = {"&lt;=": "\u2264", "&gt;=": "\u2265"}
PLAIN = range(-3, 5)  # exponents of numbers that need no power of ten
RAISED = str.maketrans(
    "-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"
)
RESULTS = re.compile(r'<table class="results">.*?</table>', re.S)
ROW = re.compile(r"<tr>.*?</tr>", re.S)
LABEL = re.compile(r'<th scope="row">([^<]{15,})</th>')  # of a row, and long
ENTRY = re.compile(r"<(?:td|th)(?=[ >])")
PHRASE = re.compile(r"[^\W\d]\S* \S")  # begins with a word, and another one follows
HYPHEN = re.compile(r"(?<![^\s(])-(?=\d)")
INTERVAL = re.compile(r" (?=\([^()<]* to [^()<]*\))")  # the space before: "2.5 (1.0 to 4.0)"
PROSE = (nodes.title, nodes.paragraph, nodes.caption, nodes.emphasis, nodes.strong)
ROLES = re.compile(r' role="(?:list|doc-biblioentry)"(?=[^>]*>)')


def description(doctree):
    """Return the first sentences of a page that can be read without their formulas."""
    for paragraph in doctree.findall(nodes.paragraph):
        if isinstance(paragraph.parent, nodes.section):
            text = " ".join(_marked(paragraph).split())
            kept = [s for s in SENTENCE.findall(text) if not NEEDED.search(s)]
            text = " ".join(" ".join(kept).replace(FORMULA, "").split())
            whole = re.match(rf".{{1,{LONGEST}}}{END}", text)
            if text:
                return whole[0] if whole else text[:LONGEST].rsplit(" ", 1)[0] + " …"
    return ""


def _marked(paragraph):
    """Return the text of a paragraph, with a mark where a formula was."""
    return "".join(
        FORMULA if isinstance(child, nodes.math) else child.astext() for child in paragraph.children
    )


def unique_ids(app, doctree):
    """Number the ids that sphinx_exercise gives to every exercise of a page."""
    sections = [s for s in doctree.findall(nodes.section) if REPEATED & set(s["ids"])]
    for place, section in enumerate(sections, start=1):
        section["ids"] = [
            f"{name}-{place}" if name in REPEATED else name for name in section["ids"]
        ]


def true_signs(app, doctree):
    """Print the minus that a hyphen before a number is meant to be, and powers; code keeps them."""
    for text in list(doctree.findall(nodes.Text)):
        if isinstance(text.parent, PROSE) and (printed := _printed(text)) != text:
            text.parent.replace(text, nodes.Text(printed))


def natural_sizes(app, doctree):
    """Show figures at one scale, so that the letters of all have the size of the text."""
    for image in doctree.findall(nodes.image):
        path = Path(app.srcdir, image["uri"])
        if path.suffix == ".png":
            width = int.from_bytes(path.read_bytes()[16:20])  # the first of its header
            image["width"] = f"{round(SCALE * width)}px"


def describe(app, pagename, template, context, doctree):
    """Add description, picture and the button that leads to the citation."""
    base = app.config.html_baseurl
    path = f"_static/{PICTURE}"
    picture = f"{base}{path}" if base else context["pathto"](path, 1)
    about = {
        "og:title": re.sub("<[^>]*>", "", context.get("title", "")),
        "og:site_name": app.config.html_title,
        "og:type": "article",
        "og:image": picture,
    }
    tags = ""
    if doctree is not None and (text := description(doctree)):
        about |= {"og:description": text}
        tags = f'<meta name="description" content="{escape(text)}" />\n'
    for name, text in about.items():
        tags += f'<meta property="{name}" content="{escape(text)}" />\n'
    context["metatags"] = context.get("metatags", "") + tags
    if "about" in app.env.all_docs:
        url = context["pathto"]("about").rstrip("#") + "#cite"
        context["header_buttons"].append(CITE | {"url": url})
    if "body" in context:
        context["body"] = repaired(context["body"])
    for _, entries in context.get("genindexentries", ()):
        # Each module stands below "module", and the page of its names is in the contents.
        entries[:] = [entry for entry in entries if not entry[0].startswith("dopplerlib.")]


def repaired(body):
    """Return a page whose tables have minuses, powers and no empty heads; its lists hold items."""
    body = EMPTY_HEAD.sub("<td></td>", body)
    body = CELL.sub(lambda m: _printed(m[0]), body)
    body = RESULTS.sub(lambda m: _phrases(INTERVAL.sub(" <wbr>", m[0])), body)
    return ROLES.sub("", body) if "citation-list" in body else body


def _printed(text):
    """Return a text with the signs of print for those of a program."""
    for typed, sign in SIGNS.items():
        text = text.replace(typed, sign)
    return HYPHEN.sub("\u2212", POWER.sub(_power, text))


def _power(number):
    """Return a number that was written with an "e" as it is printed."""
    digits, exponent = number[1], int(number[2])
    if exponent in PLAIN or not float(digits):
        return f"{Decimal(number[0]):f}"
    return f"{digits}\u00b7".removeprefix("1\u00b7") + "10" + str(exponent).translate(RAISED)


def _phrases(table):
    """Return a table of results whose columns with phrases or long labels are marked as such."""
    rows = [re.findall(r"<td>(.*?)</td>", row, re.S) for row in ROW.findall(table)]
    columns = {n for row in rows for n, cell in enumerate(row, 1) if PHRASE.match(unescape(cell))}
    if LABEL.search(table):
        columns.add(0)

    def marked(row):
        place = count()
        return ENTRY.sub(
            lambda entry: entry[0] + ' class="phrase"' * (next(place) in columns), row[0]
        )

    return ROW.sub(marked, table) if columns else table


def drop_old_pages(app, exception):
    """Remove the pages of an earlier build whose source is gone: their links go astray."""
    if exception:
        return
    kept = {*app.env.found_docs, "index", "genindex", "search"}
    for path in Path(app.outdir).rglob("*.html"):
        page = path.relative_to(app.outdir).with_suffix("").as_posix()
        if page not in kept and not page.startswith(("_modules/", "_static/")):
            path.unlink()


def setup(app):
    """Register the extension with Sphinx."""
    app.config.html_search_scorer = str(Path(__file__).with_name("scorer.js"))
    app.connect("doctree-read", unique_ids)
    app.connect("doctree-read", true_signs)
    app.connect("doctree-read", natural_sizes)
    app.connect("build-finished", drop_old_pages)
    app.connect("html-page-context", describe, priority=800)  # when the theme has its buttons
    return {"parallel_read_safe": True, "parallel_write_safe": True}

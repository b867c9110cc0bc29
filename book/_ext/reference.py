"""Write the pages of the reference from the packages, and show the source of all the others.

On a page, the fence ```` ```{reference} dopplerlib.model ```` ``` stands for a table of the public
names of that package and an entry for each of them, module by module. What `dopplerlib` gives from
its top is shown under that name. So a new module, or a new function in one, needs no edit.

Where that would be too long a page, another one takes some modules, with their names behind that of
the package; the first page shows the rest.

Packages that no page shows are in the book as source: a link to one of their functions leads there.
"""

import ast
import re
from importlib import import_module
from importlib.util import find_spec
from inspect import cleandoc
from pathlib import Path

from docutils import nodes
from sphinx.pycode import ModuleAnalyzer

import dopplerlib

FENCE = re.compile(r"^```\{reference\} (\S+)(.*)\n```$", re.M)
SOURCE_ONLY = ("dopplerlib.figures", "dopplerlib.systems")
BACK = re.compile(
    r'(class="viewcode-back" href="[^"]*#)dopplerlib\.(?:[a-z_]\w*\.)*(\w+)((?:\.\w+)?")'
)
DIRECTIVES = {"class": "autoclass", "exception": "autoexception", "function": "autofunction"}


def public_modules(package):
    """Return the dotted names of the modules of a package that a reader may import."""
    folder = _path(package).parent
    paths = [path.relative_to(folder).with_suffix("") for path in sorted(folder.rglob("*.py"))]
    return [
        ".".join([package, *path.parts])
        for path in paths
        if not any(part.startswith("_") for part in path.parts)
    ]


def public_names(module):
    """Return (name, kind) of what a module defines or, in `__all__`, hands on, in its order."""
    tree = ast.parse(_path(module).read_text(encoding="utf8"))
    found = {}
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.level == 1 and _hands_on(tree):
            there = dict(public_names(f"{module.rpartition('.')[0]}.{node.module}"))
            found |= {alias.name: there[alias.name] for alias in node.names}
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef)) and node.name[0] != "_":
            found[node.name] = _kind(node)
    return list(found.items())


def _hands_on(tree):
    return any(ast.unparse(node).startswith("__all__ =") for node in tree.body)


def _kind(node):
    if isinstance(node, ast.FunctionDef):
        return "function"
    return "exception" if any("Error" in ast.unparse(base) for base in node.bases) else "class"


def shown_as(module, name):
    """Return the path by which a name is imported: the shortest one that there is."""
    home = dopplerlib._HOME.get(name)
    return f"dopplerlib.{name}" if f"dopplerlib.{home}" == module else f"{module}.{name}"


def summary(module):
    """Return the first line of the docstring of a module, without its full stop."""
    doc = ast.get_docstring(ast.parse(_path(module).read_text(encoding="utf8")))
    return cleandoc(doc).partition("\n")[0].rstrip(".")


def page(modules):
    """Return the table and the entries of some modules of one package, as MyST."""
    text = []
    for module in modules:
        names = [f"   ~{shown_as(module, name)}" for name, _ in public_names(module)]
        text += ["", f".. rubric:: {summary(module)}", ""]
        text += [".. autosummary::", "   :nosignatures:", "", *names]
    text = _rst(text)
    for module in modules:
        entries = [f".. automodule:: {module}", ""]
        for name, kind in public_names(module):
            entries += [f".. {DIRECTIVES[kind]}:: {shown_as(module, name)}"]
            entries += ["   :members:", ""] if kind == "class" else [""]
        text += f"\n## {'.'.join(module.split('.')[2:])}\n\n" + _rst(entries)
    return text


def _rst(lines):
    return "\n".join(["```{eval-rst}", *lines, "```", ""])


def _path(module):
    return Path(find_spec(module).origin)


def fences(folder):
    """Return, by package, the modules that fences name on the pages of a folder and below."""
    found = {}
    for path in sorted(folder.rglob("*.md")):
        for package, modules in FENCE.findall(path.read_text(encoding="utf8")):
            found.setdefault(package, []).extend(f"{package}.{name}" for name in modules.split())
    return found


def modules_of(fence, named):
    """Return the modules that a fence stands for: those it names, or all that no other names."""
    package, modules = fence
    chosen = [f"{package}.{name}" for name in modules.split()]
    return chosen or [module for module in public_modules(package) if module not in named[package]]


def write(app, docname, source):
    """Put the table and the entries in the place of the fence."""
    found = FENCE.findall(source[0])
    if found:
        named = fences(Path(app.srcdir, "reference"))
        app.env.metadata[docname]["reference"] = [package for package, _ in found]
        source[0] = FENCE.sub(lambda m: page(modules_of(m.groups(), named)), source[0])


def outdated(app, env, *_):
    """Return the pages whose packages, or whose neighbors, may divide the modules otherwise now."""
    neighbors = [path.stat().st_mtime for path in Path(app.srcdir, "reference").iterdir()]
    return [
        docname
        for docname, metadata in env.metadata.items()
        for package in metadata.get("reference", ())
        if 1e6 * max(_path(package).parent.stat().st_mtime, *neighbors) > env.all_docs[docname]
    ]


def add_sources(app, env):
    """Give viewcode the modules that no page shows."""
    for package in SOURCE_ONLY:
        for module in public_modules(package):
            analyzer = ModuleAnalyzer.for_module(module)
            analyzer.find_tags()
            env._viewcode_modules[module] = (analyzer.code, analyzer.tags, {}, module)


def drop_outdated_sources(app):
    """Remove the pages of source that are older than what divides the reference into pages.

    Sphinx writes them again only if their module is newer; their links back would go astray.
    """
    rules = [Path(__file__), *Path(app.srcdir, "reference").iterdir()]
    newest = max(path.stat().st_mtime for path in rules)
    for page in Path(app.outdir, "_modules").rglob("*.html"):
        if page.stat().st_mtime < newest:
            page.unlink()


def link_to_source(app, env, node, contnode):
    """Resolve a reference to a function that no page shows: its line in the source."""
    target = node.get("reftarget", "")
    if node.get("refdomain") != "py" or not target.startswith(SOURCE_ONLY):
        return None
    package, _, name = target.rpartition(".")
    module = getattr(getattr(import_module(package), name, None), "__module__", "")
    if not module.startswith(SOURCE_ONLY):
        return None
    place = app.builder.get_relative_uri(node["refdoc"], f"_modules/{module.replace('.', '/')}")
    return nodes.reference("", "", contnode, refuri=f"{place}#:~:text={name}(", internal=True)


def lead_back(app, pagename, template, context, doctree):
    """Aim the links of a page of source at the names by which the reference shows them.

    Sphinx takes the path of the first name of a module for that of all.
    """
    if pagename.startswith("_modules/dopplerlib/"):
        module = pagename.removeprefix("_modules/").replace("/", ".")
        objects = app.env.get_domain("py").objects
        shown = [name for name, entry in objects.items() if not entry.aliased]

        def aimed(match):
            own = shown_as(module, match[2])
            handed_on = (name for name in shown if name.endswith(f".{match[2]}"))
            return f"{match[1]}{own if own in shown else next(handed_on, own)}{match[3]}"

        context["body"] = BACK.sub(aimed, context["body"])


def setup(app):
    """Register the extension with Sphinx."""
    app.connect("builder-inited", drop_outdated_sources)
    app.connect("source-read", write)
    app.connect("env-get-outdated", outdated)
    app.connect("env-updated", add_sources)
    app.connect("missing-reference", link_to_source)
    app.connect("html-page-context", lead_back)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

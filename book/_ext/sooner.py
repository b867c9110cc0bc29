"""Build the same pages sooner.

Most pages are sources of modules. Their navigation leads to the same chapters, and none of its
entries is the page itself: it differs only by the depth of the folder, and is made once for each.
For each citation, the packages of the environment were asked who sets it, and for each function of
the reference its source was parsed for comments with types, of which there are none.
"""

from functools import cache

from pybtex import plugin
from sphinx.ext.autodoc.type_comment import update_annotations_using_type_comments


def share_navigation(app, pagename, template, context, doctree):
    """Let pages of source that are as deep take over the navigation of the first of them."""
    if not pagename.startswith("_modules/"):
        return
    make, depth = context["toctree"], pagename.count("/")

    def shared(**options):
        key = depth, *sorted(options.items())
        if key not in app._navigation:
            app._navigation[key] = make(**options)
        return app._navigation[key]

    context["toctree"] = shared


def trust_templates(app):
    """Do not look, each time that a template is used, whether its file has changed meanwhile."""
    if app.builder.format == "html":
        app.builder.templates.environment.auto_reload = False


def drop_type_comments(app, config):
    """Take away who looks for them, which has no setting of its own."""
    for listener in list(app.events.listeners["autodoc-before-process-signature"]):
        if listener.handler is update_annotations_using_type_comments:
            app.disconnect(listener.id)


def setup(app):
    """Register the extension with Sphinx."""
    plugin._load_entry_point = cache(plugin._load_entry_point)
    app._navigation = {}
    app.connect("config-inited", drop_type_comments)
    app.connect("builder-inited", trust_templates)
    app.connect("html-page-context", share_navigation, priority=400)  # before the theme asks
    return {"parallel_read_safe": True, "parallel_write_safe": True}

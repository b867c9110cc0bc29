"""Number every displayed formula of a chapter, so that each can be cited and linked to.

MyST numbers those that have a label, and `math_number_all` those of the directive. A formula
without a label gets one from its page and its place on it; those that a cell prints have the anchor
of the cell.
"""

from docutils import nodes
from sphinx.transforms import SphinxTransform


class NumberFormulas(SphinxTransform):
    """Give labels and targets to the formulas that have none."""

    default_priority = 250  # before docutils hands the id of a target on to what follows it

    def apply(self, **kwargs):
        """Do so on the pages that are notebooks."""
        docname = self.env.docname
        if not self.env.doc2path(docname).endswith(".ipynb"):
            return
        domain = self.env.get_domain("math")
        written = [node for node in self.document.findall(nodes.math_block) if not _printed(node)]
        for place, node in enumerate(written, start=1):
            if node.get("label"):
                continue
            label = f"{docname}-{place}"
            domain.note_equation(docname, label, location=node)
            node["label"], node["docname"] = label, docname
            node["number"] = domain.get_equation_number_for(label)
            target = nodes.target("", "", ids=[nodes.make_id(f"equation-{label}")])
            self.document.note_explicit_target(target)
            node.parent.insert(node.parent.index(node), target)


def _printed(node):
    while node is not None:
        if node.get("nb_element") == "cell_code_output":
            return True
        node = node.parent
    return False


def setup(app):
    """Register the extension with Sphinx."""
    app.add_transform(NumberFormulas)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

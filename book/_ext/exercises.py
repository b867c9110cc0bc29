"""Say below the title of an exercise what it takes: paper, a computer, or an afternoon.

A solution with a code cell takes a computer, unless the exercise has the class `hand`: then the
cell only confirms what paper gives. An exercise of class `project` is a small project.
"""

from docutils import nodes
from sphinx_exercise.nodes import exercise_enumerable_node, solution_node

BY_HAND, COMPUTER, PROJECT = "By hand", "At the computer", "A small project"


def grade(app, doctree):
    """Give every exercise of a page its grade."""
    computed = {
        solution["target_label"]
        for solution in doctree.findall(solution_node)
        if any(node.get("nb_element") == "cell_code" for node in solution.findall(nodes.container))
    }
    for exercise in doctree.findall(exercise_enumerable_node):
        text = COMPUTER if exercise["label"] in computed else BY_HAND
        text = BY_HAND if "hand" in exercise["classes"] else text
        text = PROJECT if "project" in exercise["classes"] else text
        content = exercise.next_node(nodes.section)
        content.insert(0, nodes.paragraph("", text, classes=["grade"]))


def setup(app):
    """Register the extension with Sphinx."""
    app.connect("doctree-read", grade)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

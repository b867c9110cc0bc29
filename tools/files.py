"""Write a file whole or not at all."""


def write(path, text):
    """Replace the file in one step: an interrupted run leaves the old one."""
    temporary = path.with_name(path.name + ".tmp")
    temporary.write_text(text, encoding="utf8", newline="\n")
    temporary.replace(path)

"""Broken files: what can happen to bytes, to lines of TOML, and to a JSON document."""

import json

from hypothesis import strategies as st

# Values in JSON and TOML that have another type, another sign or another size than expected.
VALUES = (
    '"text"', '""', '"2020-01-01"', '"é\\u0000"', "1", "0", "-1", "1.5", "-0.0", "1e308", "1e999",
    "9" * 400, "2e9", "true", "false", "[]", "{}", "[1]", '["a"]', "[[1, 2], [3]]", "[1e308, -1]",
    "[" * 3000 + "]" * 3000, '"' + "x" * 5000 + '"', "99999999999",
)  # fmt: skip
TOML_VALUES = (*VALUES, "nan", "-inf", "2020-01-01", "12:30:00", "{a = 1}", "'x'", "0x10", "1_000")
JSON_VALUES = (*VALUES, "null", "NaN", "-Infinity", '{"a": 1}', '{"a": {"b": []}}')


@st.composite
def bytes_of(draw, data):
    """Change bytes: bits flipped, a file cut, bytes put in, left out or repeated."""
    data = bytearray(data)
    for _ in range(draw(st.integers(1, 2))):
        kind = draw(st.sampled_from(("flip", "cut", "put", "leave out", "repeat", "size", "empty")))
        place = draw(st.integers(0, max(len(data) - 1, 0)))
        some = data[place : place + draw(st.integers(1, 40))]
        if kind == "flip" and data:
            data[place] ^= 1 << draw(st.integers(0, 7))
        elif kind == "cut":
            del data[place:]
        elif kind == "put":
            data[place:place] = draw(st.binary(min_size=1, max_size=20))
        elif kind == "leave out":
            del data[place : place + len(some)]
        elif kind == "repeat":
            data[place:place] = some * draw(st.integers(1, 50))
        elif kind == "size":
            data[place : place + 4] = draw(st.sampled_from((b"\xff" * 4, b"\0" * 4, b"\0\0\0\x80")))
        elif kind == "empty":
            del data[:]
    return bytes(data)


@st.composite
def toml_of(draw, text):
    """Change lines of a TOML file: other values, keys renamed, left out, repeated, added."""
    lines = text.splitlines()
    for _ in range(draw(st.integers(1, 2))):
        places = [place for place, line in enumerate(lines) if line.strip() and line[0] != "#"]
        place = draw(st.sampled_from(places)) if places else 0
        key = lines[place].split("=")[0].strip() if lines else "key"
        value = draw(st.sampled_from(TOML_VALUES))
        action = draw(
            st.sampled_from(
                ("value",) * 4 + ("leave out", "repeat", "rename", "add", "table", "plain table")
            )
        )
        if not lines or action == "add":
            lines.insert(place, f"unknown = {value}")
        elif action == "value" and "=" in lines[place]:
            lines[place] = f"{key} = {value}"
        elif action == "leave out":
            del lines[place]
        elif action == "repeat":
            lines.insert(place, lines[place])
        elif action == "rename":
            lines[place] = "x" + lines[place] if "=" in lines[place] else "[x]"
        elif action == "table":
            lines[place] = f"{key.strip('[]')} = {value}"
        else:
            lines[place] = f"[{key.strip('[]')}]"
    end, code = draw(
        st.sampled_from((("\n", "utf-8"),) * 6 + (("\r\n", "utf-8-sig"), ("\n", "utf-16")))
    )
    return (end.join(lines) + end).encode(code)


@st.composite
def json_of(draw, text):
    """Change nodes of a JSON document: other values, keys renamed, left out, repeated, added."""
    document = json.loads(text)
    marks = {}
    for number in range(draw(st.integers(1, 2))):
        holders = list(_holders(document))
        if not holders:
            break
        holder, key = draw(st.sampled_from(holders))
        mark = f"@{number}@"
        marks[json.dumps(mark)] = draw(st.sampled_from(JSON_VALUES))
        action = draw(st.sampled_from(("value",) * 4 + ("leave out", "rename", "repeat", "add")))
        if action == "leave out":
            del holder[key]
        elif action == "rename" and isinstance(holder, dict):
            holder[f"{key}x"] = holder.pop(key)
        elif action == "repeat" and isinstance(holder, dict):
            holder[mark] = 1  # becomes a second entry of the same name
            marks[f"{json.dumps(mark)}: 1"] = f"{json.dumps(key)}: {marks.pop(json.dumps(mark))}"
        elif action == "add" and isinstance(holder, dict):
            holder["core:unknown"] = mark
        else:
            holder[key] = mark
    text = json.dumps(document)
    for mark, value in marks.items():
        text = text.replace(mark, value)
    return text.encode()


def _holders(node):
    """Yield (container, key) of every node below `node`."""
    for key, child in list(node.items() if isinstance(node, dict) else enumerate(node)):
        yield node, key
        if isinstance(child, (dict, list)):
            yield from _holders(child)

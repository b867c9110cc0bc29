"""The build must refuse a page that loads anything from elsewhere."""

import importlib.util
from pathlib import Path
from types import SimpleNamespace

import pytest
from sphinx.errors import ExtensionError

SOURCE = Path(__file__).resolve().parents[2] / "book" / "_ext" / "offline.py"
spec = importlib.util.spec_from_file_location("offline", SOURCE)
offline = importlib.util.module_from_spec(spec)
spec.loader.exec_module(offline)

REMOTE = [
    '<script src="https://example.org/a.js"></script>',
    "<script async src='//example.org/a.js'></script>",
    "<SCRIPT SRC=HTTPS://example.org/a.js></SCRIPT>",
    '<link href="https://example.org/a.css" rel="stylesheet">',
    '<link rel="preconnect" href="https://example.org">',
    '<img alt="a > b" src="http://example.org/a.png">',
    '<img srcset="a.png 1x, https://example.org/b.png 2x">',
    '<iframe src="https://example.org"></iframe>',
    '<object data="https://example.org/a.svg"></object>',
    '<svg><image href="https://example.org/a.png"/></svg>',
    '<p style="background: url(https://example.org/a.png)">',
    '<p class="a" style="background: url(https://example.org/a.png)">',
    '<p title="<span>"><span class="a" src="https://example.org/a.png"></span></p>',
    '<style>@import "https://example.org/a.css";</style>',
]
LOCAL = [
    '<a href="https://example.org">a link is followed only when the reader wants it</a>',
    '<script src="_static/a.js"></script>',
    '<script>const home = "https://example.org";</script>',
    '<img src="data:image/png;base64,AAAA//AAAA">',
    '<link rel="canonical" href="https://example.org">',
    '<svg xmlns="http://www.w3.org/2000/svg"><use xlink:href="#a"/></svg>',
    '<style>p { background: url("a.png") }</style><p>url(https://example.org)</p>',
]


@pytest.mark.parametrize("page", REMOTE)
def test_a_remote_asset_is_found(page):
    assert len(offline.remote_assets(page)) == 1


@pytest.mark.parametrize("page", LOCAL)
def test_links_and_local_assets_are_left_alone(page):
    assert offline.remote_assets(page) == []


def test_a_style_sheet_is_read_too():
    remote = "@font-face { src: url('https://example.org/a.woff2') }"
    assert offline.remote_assets(remote, ".css") == ["https://example.org/a.woff2"]
    assert offline.remote_assets("@font-face { src: url(a.woff2) }", ".css") == []


@pytest.mark.parametrize("page", REMOTE)
def test_the_build_fails_and_names_the_page(tmp_path, page):
    app = SimpleNamespace(outdir=tmp_path, builder=SimpleNamespace(format="html"))
    (tmp_path / "good.html").write_text("\n".join(LOCAL), encoding="utf8")
    offline.refuse_remote(app, None)
    (tmp_path / "bad.html").write_text(page, encoding="utf8")
    with pytest.raises(ExtensionError, match=r"bad\.html"):
        offline.refuse_remote(app, None)

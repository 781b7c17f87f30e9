"""The documentation as a site: it is built with every link right, asks nothing of others, and the API serves it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from benchmarks.dashboard.accessibility import SCHEMES, axe_of_text
from benchmarks.dashboard.browser import CHROMIUM, SPARING, browsing, serving
from service.api import documentation
from service.api.app import create_app
from service.settings import Settings

ROOT = Path(__file__).parents[2]
LOADED = re.compile(r"""<(?:script|img|iframe|source)\b[^>]*\bsrc=["']?(https?:)?//|<link\b[^>]*\brel=["']?(?:stylesheet|preconnect|icon)["']?[^>]*\bhref=["']?(https?:)?//""")  # noqa: E501
IN_THE_DARK = {"accuracy", "client", "dashboard", "deploy", "physics", "runbook", "tutorial"}
"""Pages with all that has a colour; make bench-dashboard looks at all of them in both schemes."""
PALE = """() => {
  const [text] = [...document.querySelectorAll("article p")].slice(-1);
  text.id = "pale";
  text.style.opacity = 0.2;
}"""
"""Has the last paragraph of a page be as good as none."""
FETCHED = re.compile(r"""(?:url\(|@import\s+)["']?(?:https?:)?//""")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    for module in ("mkdocs", "latex2mathml"):
        pytest.importorskip(module, reason="no MkDocs: make .venv/.docs")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    return folder


@pytest.fixture
def client(site, tmp_path, monkeypatch):
    monkeypatch.setattr(documentation, "SITE", site)
    with TestClient(create_app(Settings(tmp_path), keyed=True), base_url="http://127.0.0.1") as client:
        yield client


def test_it_asks_nothing_of_others(site):
    pages = {path: path.read_text(encoding="utf-8") for path in site.rglob("*.html")}
    assert len(pages) > 30
    assert [path for path, text in pages.items() if LOADED.search(text)] == []
    styles = {path: path.read_text(encoding="utf-8") for path in site.rglob("*.css")}
    assert styles and [path for path, text in styles.items() if FETCHED.search(text)] == []


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium: apt-get install chromium")
@pytest.mark.parametrize("scheme", SCHEMES)
def test_axe_finds_nothing_on_any_page(site, tmp_path, monkeypatch, scheme):
    pytest.importorskip("playwright.sync_api", reason="Playwright's Python package is not installed")
    monkeypatch.setattr(documentation, "SITE", site)
    found = {}
    with serving(Settings(tmp_path)) as server, browsing(*SPARING) as opened:
        page = opened()
        page.emulate_media(color_scheme=scheme)
        for path in sorted(site.rglob("index.html")):
            if "decisions" in path.parts and "0006" <= path.parent.name < "9999":
                continue  # they are many and alike
            if scheme == "dark" and path.parent.name not in IN_THE_DARK:
                continue
            page.goto(f"{server.address}/docs/{path.parent.relative_to(site).as_posix()}/".replace("/./", "/"))
            found[path] = axe_of_text(page).violations
        page.evaluate(PALE)
        pale = axe_of_text(page).violations
        assert len(pale) == 1 and "color-contrast" in pale[0] and "pale" in pale[0]
    assert len(found) > (15 if scheme == "light" else 5) and {path: told for path, told in found.items() if told} == {}


def test_formulas_need_no_program(site):
    page = (site / "physics" / "index.html").read_text(encoding="utf-8")
    assert page.count("<math") > 20 and "$`" not in page and "```math" not in page


def test_every_operation_stands_on_its_page(site, tmp_path):
    page = (site / "http" / "index.html").read_text(encoding="utf-8")
    text = re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page))
    operations = [f"{method.upper()} {path}" for path, its in create_app(Settings(tmp_path)).openapi()["paths"].items()
                  for method in its]  # fmt: skip
    assert operations and [one for one in operations if one not in text] == []


def test_every_schema_stands_on_the_page_of_the_interface_once(site, tmp_path):
    page = (site / "http" / "index.html").read_text(encoding="utf-8")
    schemas = create_app(Settings(tmp_path)).openapi()["components"]["schemas"]
    assert schemas and [name for name in schemas if page.count(f'<h3 id="{name.lower()}"') != 1] == []
    [limit] = re.findall(r"<td><code>limit</code></td>\s*<td>query</td>\s*<td>50</td>\s*<td>([^<]*)</td>", page)[:1]
    assert limit == "integer, 1 to 200"


def test_the_api_serves_it_without_a_key(client):
    found = {"/docs": "first-ten-minutes", "/docs/physics/": "<math", "/docs/search/search_index.json": "Kirchhoff"}
    for address, part in found.items():
        answer = client.get(address)
        assert answer.status_code == 200 and part in answer.text
        assert "default-src 'self'" in answer.headers["content-security-policy"]


@pytest.mark.parametrize("name", ["none", "%2e%2e/api/app.py", "physics/%2e%2e/%2e%2e/api/app.py", "%2Fetc/passwd"])
def test_nothing_else_is_served(client, name):
    answer = client.get(f"/docs/{name}")
    assert answer.status_code == 404 and answer.headers["content-type"] == "application/problem+json"


def test_where_it_is_not_built_that_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(documentation, "SITE", tmp_path / "none")
    with TestClient(create_app(Settings(tmp_path)), base_url="http://127.0.0.1") as client:
        answer = client.get("/docs/")
    assert answer.status_code == 404 and "make site" in answer.json()["detail"]

"""What axe's rules find on pages, in light and in dark."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from service.api.documentation import SITE

SCHEMES = ("light", "dark")


@dataclass(frozen=True)
class Audit:
    """How many rules held, and which did not, each with its element."""

    passed: int
    violations: list[str]


def axe(page: Any) -> Audit:
    """Of the page as it is shown."""
    from axe_playwright_python.sync_playwright import Axe

    results = Axe().run(page).response
    broken = [f"{rule['id']}: {node['target']}" for rule in results["violations"] for node in rule["nodes"]]
    return Audit(len(results["passes"]), broken)


def version() -> str:
    """Of the rules."""
    from axe_playwright_python.sync_playwright import Axe

    match = re.search(r"axe v([\d.]+)", Axe().axe_script[:200])
    return match[1] if match else "of unknown version"


def documentation() -> list[str]:
    """The addresses of the pages of the site, which must have been built (make site)."""
    if not SITE.is_dir():
        raise SystemExit("the documentation has not been built here: make site")
    folders = sorted(path.parent.relative_to(SITE).as_posix() for path in SITE.rglob("index.html"))
    return ["/docs/" if name == "." else f"/docs/{name}/" for name in folders]


def rows(page: Any, address: str, ready: Mapping[str, str]) -> list[str]:
    """A row of a table for each page of `ready`, which has a selector of what is on it when it is filled."""
    table = []
    for path, selector in ready.items():
        audits = []
        for scheme in SCHEMES:
            page.emulate_media(color_scheme=scheme)
            page.goto(address + path)
            page.wait_for_selector(selector, state="attached")
            audits.append(axe(page))
        shown = re.sub(r"/01\w+", "/ID", path.split("?")[0])
        broken = " | ".join(str(len(audit.violations)) for audit in audits)
        table.append(f"| `{shown}` | {audits[0].passed} | {broken} |")
    page.emulate_media(color_scheme="light")
    return table

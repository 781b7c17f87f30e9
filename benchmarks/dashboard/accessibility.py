"""What axe's rules find on pages, in light and in dark."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from service.api.documentation import SITE

SCHEMES = ("light", "dark")


@dataclass(frozen=True)
class Found:
    """How many rules held, and which did not, each with its element."""

    held: int
    violations: list[str]


def axe(page: Any) -> Found:
    """Of the page as it is shown."""
    from axe_playwright_python.sync_playwright import Axe

    told = Axe().run(page).response
    broken = [f"{rule['id']}: {node['target']}" for rule in told["violations"] for node in rule["nodes"]]
    return Found(len(told["passes"]), broken)


def version() -> str:
    """Of the rules."""
    from axe_playwright_python.sync_playwright import Axe

    found = re.search(r"axe v([\d.]+)", Axe().axe_script[:200])
    return found[1] if found else "of unknown version"


def documentation() -> list[str]:
    """The addresses of the pages of the site, which must have been built (make site)."""
    if not SITE.is_dir():
        raise SystemExit("the documentation has not been built here: make site")
    folders = sorted(path.parent.relative_to(SITE).as_posix() for path in SITE.rglob("index.html"))
    return ["/docs/" if name == "." else f"/docs/{name}/" for name in folders]


def rows(page: Any, address: str, ready: Mapping[str, str]) -> list[str]:
    """A row of a table for each page of `ready`, which names what is on it when it is filled."""
    made = []
    for path, there in ready.items():
        found = []
        for scheme in SCHEMES:
            page.emulate_media(color_scheme=scheme)
            page.goto(address + path)
            page.wait_for_selector(there, state="attached")
            found.append(axe(page))
        shown = re.sub(r"/01\w+", "/ID", path.split("?")[0])
        made.append(f"| `{shown}` | {found[0].held} | " + " | ".join(str(len(one.violations)) for one in found) + " |")
    page.emulate_media(color_scheme="light")
    return made

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

    return _audit(Axe().run(page).response)


def _audit(results: Any) -> Audit:
    broken = [f"{rule['id']}: {node['target']}" for rule in results["violations"] for node in rule["nodes"]]
    return Audit(len(results["passes"]), broken)


CONTRAST = "color-contrast"
MARK = """() => {
  const met = new Map(), looks = new Map([[null, ""]]);
  const look = (element) => {
    if (!looks.has(element)) {
      const style = getComputedStyle(element);
      const own = [element.tagName, style.color, style.backgroundColor, style.backgroundImage, style.opacity,
                   style.fontSize, style.fontWeight, style.position];
      looks.set(element, `${look(element.parentElement)}${own}/`);
    }
    return looks.get(element);
  };
  for (const element of document.querySelectorAll("body *")) {
    const text = [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.data.trim());
    if (!text || !element.getClientRects().length || !element.checkVisibility({visibilityProperty: true})) continue;
    const many = met.get(look(element)) ?? 0;
    met.set(look(element), many + 1);
    if (many < 3) element.dataset.looks = "";
  }
}"""
"""Marks three of the texts that look alike: of the same sizes and colours, within elements of the same colours."""


def axe_of_text(page: Any) -> Audit:
    """The same of a page of much text that looks alike, for which to find the contrast of each takes most of the time:
    of what looks alike, that of three."""
    from axe_playwright_python.sync_playwright import Axe

    page.evaluate(MARK)
    one = Axe().run(page, options={"rules": {CONTRAST: {"enabled": False}}, "resultTypes": ["violations"]}).response
    told = [{"include": [["[data-looks]"]]}, {"runOnly": [CONTRAST], "resultTypes": ["violations"]}]
    other = page.evaluate("(told) => axe.run(...told)", told)  # the rules are there now: to load them takes longest
    audits = _audit(one), _audit(other)
    return Audit(sum(audit.passed for audit in audits), [told for audit in audits for told in audit.violations])


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

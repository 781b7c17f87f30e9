"""What the site needs beside its pages (a hook of MkDocs): the interface, the pages that are lists of files, formulas
as MathML, and links to what lies beside docs/ in the repository."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from latex2mathml.converter import convert

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.pages import Page

HERE = Path(__file__).parent
LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(([^)#:]+)(#[^)]*)?\)")
DISPLAYED = re.compile(r"^```math\n(.*?)^```$", re.M | re.S)
INTERFACE = "<!-- interface -->"
INLINE = re.compile(r"\$`([^`]+)`\$")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the list of decisions and the gallery."""
    from mkdocs.structure.files import File

    for name, text in (("decisions.md", decisions()), ("gallery.md", gallery())):
        files.append(File.generated(config, name, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Formulas as MathML; links that leave docs/ as names of files in the repository; the interface on its page."""
    place = HERE / page.file.src_uri
    if INTERFACE in markdown:
        return markdown.replace(INTERFACE, interface())
    text = DISPLAYED.sub(lambda match: convert(match[1], display="block"), markdown)
    text = INLINE.sub(lambda match: convert(match[1]), text)
    return LINK.sub(lambda match: _link(match, place.parent), text)


def on_post_page(output: str, **_: Any) -> str:
    """What the theme leaves without a name."""
    dialog = 'data-md-component="search" role="dialog"'
    return output.replace(dialog, f'{dialog} aria-label="Search"')


def interface() -> str:
    """The operations and schemas of the HTTP interface."""
    from docs.interface import page
    from service.api.app import create_app
    from service.settings import Settings

    return page(create_app(Settings()).openapi())


def decisions() -> str:
    """Each decision by its title."""
    lines = [f"- [{path.read_text().splitlines()[0].lstrip('# ')}](decisions/{path.name})"
             for path in sorted((HERE / "decisions").glob("*.md"))]  # fmt: skip
    return "# Decisions\n\nWhat a newcomer would question, one page each.\n\n" + "\n".join(lines) + "\n"


def gallery() -> str:
    """Each shipped case with the picture that `hockle plot` draws of it."""
    from service.cases import load_case, shipped_cases

    parts = ["# Gallery\n\nThe cases that come with hockle, as `hockle plot` draws them. `hockle run NAME` runs one.\n"]
    for name, title in shipped_cases().items():
        description = load_case(name).get("description", "")
        parts.append(f"## {name}\n\n{title}. {description}\n")
        if (HERE / "pictures/cases" / f"{name}.png").exists():
            parts.append(f"![{title}](pictures/cases/{name}.png)\n")
    return "\n".join(parts)


def _link(match: re.Match[str], folder: Path) -> str:
    target = Path(os.path.normpath(folder / match[2]))
    if target.is_relative_to(HERE):
        return match[0]
    if not target.exists():
        raise FileNotFoundError(f"{folder}: no {match[2]}")
    return f"{match[1]} (`{target.relative_to(HERE.parent)}`)"

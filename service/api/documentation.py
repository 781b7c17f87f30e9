"""/docs: the documentation, where its site has been built (make site) or came with the installation."""

from __future__ import annotations

from pathlib import Path

from fastapi import APIRouter
from fastapi.responses import FileResponse, RedirectResponse

from service.api.problems import Problem

SITE = Path(__file__).parent.parent / "site"
POLICY = ("default-src 'self'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; "
          "img-src 'self' data:; worker-src 'self' blob:; base-uri 'none'; form-action 'none'; "
          "frame-ancestors 'none'")  # fmt: skip
"""The site asks nothing of another server. Its theme has programs and styles within its pages."""
HEADERS = {"Content-Security-Policy": POLICY, "Cache-Control": "no-cache"}
router = APIRouter(prefix="/docs", include_in_schema=False)


@router.get("")
def front() -> RedirectResponse:
    """The pages' addresses are relative to a folder."""
    return RedirectResponse("/docs/")


@router.get("/{name:path}")
def page(name: str) -> FileResponse:
    """A page, or what it is made of."""
    if not SITE.is_dir():
        raise Problem(404, "not_found", "the documentation has not been built here: make site")
    path = (SITE / name).resolve()
    if path.is_dir():
        path /= "index.html"
    if not (path.is_relative_to(SITE.resolve()) and path.is_file()):
        raise Problem(404, "not_found", f"the documentation has no page {name[:80]!r}")
    return FileResponse(path, headers=HEADERS)

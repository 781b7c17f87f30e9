"""Every page against axe's rules, light and dark, and on a phone."""

from __future__ import annotations

import httpx
import pytest

from benchmarks.dashboard.accessibility import axe

QUICK = {"t_end": 1.0, "output__interval": 0.25, "numerics__intervals": 20}
BALL = {"start": [0.0, 0.0, 0.5], "radius": 0.1, "stiffness": 1e3}
PAGES = {"jobs": "#jobs tbody tr", "job": "#page .chart", "compare": "#page .chart",
         "new": ".verdict .cost", "ensembles": "#page tbody tr", "ensemble": "#page circle"}


NAMED = """() => [...document.querySelectorAll("#page td")].map(cell => getComputedStyle(cell, "::before").content)"""
"""What stands before the cells of a page's tables: their heads are not seen on a phone."""


@pytest.fixture
def addresses(server, run) -> dict[str, str]:
    """The address of each page, with something on it."""
    more = ({"loads__obstacles": [BALL]}, {"t_end": 0.5})
    ids = [run("cantilever-vibration", **QUICK | one) for one in more]
    body = {"case": "cantilever-vibration", "parameters": {"loads.damping": [0.5, 1.0]}}
    ensemble = httpx.post(f"{server.address}/v1/ensembles", json=body).json()["id"]
    paths = {"jobs": "", "job": f"jobs/{ids[0]}", "compare": f"compare?jobs={','.join(ids)}",
             "new": "new?case=elastica", "ensembles": "ensembles", "ensemble": f"ensembles/{ensemble}"}
    return {name: f"{server.address}/#/{path}" for name, path in paths.items()}


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_on_any_page(addresses, page, scheme):
    page.emulate_media(color_scheme=scheme)
    for name, address in addresses.items():
        page.goto(address)
        page.wait_for_selector(PAGES[name], state="attached")
        assert axe(page).violations == [], name


def test_axe_finds_nothing_on_the_login_page(keyed_server, page):
    page.goto(keyed_server.address)
    page.wait_for_selector("#login:not([hidden])")
    assert axe(page).violations == []


def test_no_page_is_wider_than_a_phone(addresses, page):
    page.set_viewport_size({"width": 360, "height": 800})
    for name, address in addresses.items():
        page.goto(address)
        page.wait_for_selector(PAGES[name], state="attached")
        assert page.evaluate("document.documentElement.scrollWidth") <= 360, name
        cells = page.evaluate(NAMED)
        assert all(before.startswith('"') for before in cells), name

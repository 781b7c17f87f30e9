"""The server is away, or refuses once, while a page is opened or used: the page is filled when it is back."""

from __future__ import annotations

import httpx
import pytest

QUICK = {"t_end": 1.0, "output__interval": 0.25, "numerics__intervals": 20}
PAGES = {"jobs": ("", "jobs?*", "#jobs tbody tr"),
         "job": ("jobs/{job}", "jobs/*/data*", "#page .chart"),
         "compare": ("compare?jobs={job},{other}", "jobs/*/data*", "#page .chart"),
         "new": ("new?case=elastica", "cases", ".verdict .cost"),
         "ensembles": ("ensembles", "ensembles*", "#page tbody tr"),
         "ensemble": ("ensembles/{ensemble}", "ensembles/*/scalars*", "#page circle")}  # fmt: skip
"""By their names: the address, what is asked for it, and what is there once it is filled."""

every_page = pytest.mark.parametrize("which", list(PAGES))


@pytest.fixture
def names(server, run) -> dict[str, str]:
    """What the addresses of the pages name."""
    body = {"case": "cantilever-vibration", "parameters": {"loads.damping": [0.5, 1.0]}}
    job, other = run("cantilever-vibration", **QUICK), run("cantilever-vibration", **QUICK)
    return {"job": job, "other": other,
            "ensemble": httpx.post(f"{server.address}/v1/ensembles", json=body).json()["id"]}


@every_page
def test_a_page_that_is_opened_while_the_server_is_away_is_filled_when_it_is_back(server, names, page, which):
    path, _, filled = PAGES[which]
    page.route("**/v1/**", lambda route: route.abort())
    page.goto(f"{server.address}/#/{path.format(**names)}")
    page.wait_for_selector("#notice:not([hidden])")
    page.unroute("**/v1/**")
    page.wait_for_selector(filled, state="attached")
    page.wait_for_selector("#notice", state="hidden")


@every_page
def test_a_page_to_which_one_part_is_refused_once_is_filled_in_the_end(server, names, page, which):
    path, asked, filled = PAGES[which]
    page.route(f"**/v1/{asked}", lambda route: route.fulfill(status=503, json={"detail": "ask later"}), times=1)
    page.goto(f"{server.address}/#/{path.format(**names)}")
    page.wait_for_selector("#notice:not([hidden])")
    page.wait_for_selector(filled, state="attached")
    page.wait_for_selector("#notice", state="hidden")
    assert page.locator("#page .player").count() <= 1


def test_a_form_that_is_filled_in_while_the_server_is_away_is_looked_at_when_it_is_back(server, page):
    page.goto(f"{server.address}/#/new?case=elastica")
    page.wait_for_selector(".verdict .cost")
    page.route("**/v1/**", lambda route: route.abort())
    page.fill("#case-rod-length", "2")
    page.wait_for_selector("#notice:not([hidden])")
    page.unroute("**/v1/**")
    page.wait_for_selector("#submit:not([disabled])")
    page.wait_for_selector("#notice", state="hidden")
    assert page.input_value("#case-rod-length") == "2"

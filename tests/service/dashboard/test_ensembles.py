"""The pages of ensembles, in a browser."""

from __future__ import annotations

import httpx
import pytest

from worker.run import run_next

DENSITIES, DAMPINGS = [1000, 1500, 2000], [0.5, 1.0]


@pytest.fixture
def ensemble(server, registry, settings):
    """The id of an ensemble of six that have run."""
    body = {"case": "cantilever-vibration", "title": "densities and dampings",
            "set": {"t_end": 0.5, "numerics.intervals": 10, "output.interval": 0.25},
            "parameters": {"density": {"path": "rod.density", "values": DENSITIES},
                           "damping": {"path": "loads.damping", "values": DAMPINGS}}}
    accepted = httpx.post(f"{server.address}/v1/ensembles", json=body)
    assert accepted.status_code == 202, accepted.text
    while run_next(registry.database, settings):
        pass
    return accepted.json()["id"]


def test_members_are_points_and_lines_that_lead_to_their_runs(server, ensemble, page):
    page.goto(f"{server.address}/#/ensembles")
    page.click("text=densities and dampings")
    page.wait_for_selector("#page circle")
    assert page.url.endswith(f"#/ensembles/{ensemble}")
    assert page.locator("#page circle").count() == page.locator("#page .member path").count() == 6
    assert "6 members: 6 successful" in page.inner_text("#page")
    point = page.locator("#page .member:has(circle)").first
    label = point.get_attribute("aria-label")
    point.click()
    page.wait_for_selector("#page .player:not([hidden])")
    assert label == "density = 1000, damping = 0.5: completed"
    page.wait_for_selector("text=rod.density")  # which differs from the shipped case
    assert "1000" in page.inner_text("#page table")


def test_the_table_of_jobs_shows_those_of_one_ensemble(server, add, ensemble, page):
    add(2)
    page.goto(f"{server.address}/#/ensembles/{ensemble}")
    page.click("text=Its jobs in the table")
    page.wait_for_function("() => document.querySelectorAll('#jobs tbody tr').length === 6")
    assert page.url.endswith(f"#/?ensemble={ensemble}")
    page.wait_for_selector("#filters [name=ensemble] option:has-text('densities')", state="attached")
    assert page.input_value("#filters [name=ensemble]") == ensemble
    page.select_option("#filters [name=ensemble]", "")
    page.wait_for_function("() => document.querySelectorAll('#jobs tbody tr').length === 8")
    page.select_option("#filters [name=ensemble]", label="densities and dampings")
    page.wait_for_function("() => document.querySelectorAll('#jobs tbody tr').length === 6")


def test_a_filter_that_is_chosen_while_the_ensembles_are_read_stays_chosen(server, add, ensemble, page):
    add(2)
    held = []
    page.route("**/v1/ensembles", lambda route: held.append(route))
    with page.expect_request("**/v1/ensembles"):
        page.goto(f"{server.address}/#/?ensemble={ensemble}")
    page.wait_for_function("() => document.querySelectorAll('#jobs tbody tr').length === 6")
    page.select_option("#filters [name=ensemble]", "")
    held[0].continue_()
    page.wait_for_function("() => document.querySelectorAll('#jobs tbody tr').length === 8")
    page.unroute_all(behavior="ignoreErrors")


def test_any_scalar_is_drawn_against_any_parameter(server, ensemble, page):
    page.goto(f"{server.address}/#/ensembles/{ensemble}")
    page.wait_for_selector("#page circle")
    page.select_option("[name=across]", "damping")
    page.select_option("[name=up]", "energy_bending")
    assert page.locator("#page figcaption").first.inner_text() == "energy_bending (J) over damping"
    places = {circle.get_attribute("cx") for circle in page.locator("#page circle").all()}
    heights = {circle.get_attribute("cy") for circle in page.locator("#page circle").all()}
    assert len(places) == len(DAMPINGS) and len(heights) > len(DENSITIES) - 1
    axes = page.locator("#page figure").nth(1).locator(".name").all_text_contents()
    assert axes == ["density", "damping", "energy_bending (J)"]


def test_results_can_be_chosen_as_soon_as_members_have_them(server, registry, settings, page):
    body = {"case": "cantilever-vibration", "set": {"t_end": 0.2, "numerics.intervals": 10, "output.interval": 0.1},
            "parameters": {"loads.damping": DAMPINGS}}
    one = httpx.post(f"{server.address}/v1/ensembles", json=body).json()["id"]
    page.goto(f"{server.address}/#/ensembles/{one}")
    page.wait_for_selector("#page circle")
    assert page.locator("[name=up] option").all_inner_texts() == ["loads.damping"]
    while run_next(registry.database, settings):
        pass
    page.wait_for_selector("#page figcaption:has-text('max_curvature (rad/m) over loads.damping')")
    page.select_option("[name=up]", "energy_bending")


def test_what_was_sampled_by_its_logarithm_is_drawn_so(server, registry, settings, page):
    body = {"case": "cantilever-vibration", "set": {"t_end": 0.2, "numerics.intervals": 10, "output.interval": 0.1},
            "parameters": {"stiffness": {"path": "rod.youngs_modulus", "values": [1e7, 1e8, 1e9]}}}
    one = httpx.post(f"{server.address}/v1/ensembles", json=body).json()["id"]
    while run_next(registry.database, settings):
        pass
    page.goto(f"{server.address}/#/ensembles/{one}")
    page.wait_for_selector("#page circle")
    first, second, third = sorted(float(point.get_attribute("cx")) for point in page.locator("#page circle").all())
    assert second - first == pytest.approx(third - second)  # 1e7, 1e8 and 1e9
    assert page.locator("#page td[data-head=stiffness]").all_inner_texts() == ["1e7", "1e8", "1e9"]
    assert page.inner_text("#page figcaption >> nth=0") == "max_curvature (rad/m) over stiffness"


def test_members_that_wait_are_cancelled_after_a_question(server, page):
    body = {"case": "cantilever-vibration", "parameters": {"loads.damping": DAMPINGS}}
    accepted = httpx.post(f"{server.address}/v1/ensembles", json=body).json()
    page.goto(f"{server.address}/#/ensembles/{accepted['id']}")
    page.click("#page button:has-text('Cancel')")
    page.click("#ask button[value=yes]")
    page.wait_for_function("() => document.querySelector('#page').innerText.includes('2 dismissed')")

"""A new case from a form, in a browser."""

from __future__ import annotations

import json

import pytest

from service.cases import load_case, parse_case, shipped_cases


@pytest.fixture
def form(server, page):
    """Opens the form with a shipped case; gives what it asks the server about, newest last."""
    asked = []
    page.on("request", lambda request: asked.append(request.post_data_json) if "/validate" in request.url else None)

    def opened(query):
        page.goto(f"{server.address}/#/new?{query}")
        page.wait_for_selector(".verdict .cost")
        return asked

    return opened


@pytest.mark.parametrize("name", shipped_cases())
def test_a_shipped_case_goes_through_the_form_unchanged(form, name):
    asked = form(f"case={name}")
    assert parse_case(asked[-1]) == parse_case(load_case(name))


def test_the_server_s_messages_stand_at_their_fields_as_one_types(form, page):
    form("case=elastica")
    page.fill("#case-rod-length", "-1")
    page.wait_for_selector("#case-rod-length-told .fault")
    assert page.inner_text("#case-rod-length-told") == "must be > 0"
    assert page.get_attribute("#case-rod-length", "aria-invalid") == "true"
    assert page.is_disabled("#submit")
    page.fill("#case-rod-length", "long")
    page.wait_for_function("() => document.querySelector('#case-rod-length-told').innerText === 'must be a number'")
    page.fill("#case-rod-length", "1")
    page.wait_for_selector(".verdict .cost")
    assert page.inner_text("#case-rod-length-told") == ""
    assert page.is_enabled("#submit")


def test_what_is_refused_is_named_beside_the_submission_and_its_name_leads_to_the_field(form, page):
    form("case=elastica")
    page.fill("#case-rod-length", "-1")
    page.fill("#case-output-interval", "0")
    page.wait_for_function("() => document.querySelectorAll('.verdict .fault').length === 2")
    told = page.locator(".verdict .fault").all_inner_texts()
    assert told == ["rod.length must be > 0", "output.interval must be > 0"]
    page.click(".verdict .fault button >> nth=1")
    assert page.evaluate("document.activeElement.id") == "case-output-interval"


def test_likely_slips_are_told_and_do_not_hinder(form, page):
    form("case=hanging-cable")
    page.fill("#case-loads-gravity", "[0, 0, 9.81]")
    page.wait_for_selector("#case-loads-gravity-told .warning")
    assert page.is_enabled("#submit")


def test_the_cost_is_told_before_one_submits(form, page):
    form("case=elastica")
    assert "1 core" not in page.inner_text(".cost") and "of one core: 101 nodes" in page.inner_text(".cost")
    page.fill("#case-numerics-intervals", "200")
    page.wait_for_function("() => document.querySelector('.cost')?.innerText.includes('201 nodes')")


def test_parts_that_a_case_may_lack_are_added_and_left_out(form, page):
    asked = form("case=elastica")
    assert "fluid" not in asked[-1]
    page.check("fieldset:has(#case-fluid-density) legend input")
    page.wait_for_selector("#case-fluid-density-told .fault")
    page.fill("#case-fluid-density", "1000")
    page.wait_for_selector(".verdict .cost")
    assert asked[-1]["fluid"] == {"density": 1000}


def test_obstacles_are_given_as_a_list_and_seen_in_the_preview(form, page):
    asked = form("case=elastica")
    ball = {"start": [0.3, 0.0, 0.5], "radius": 0.1, "stiffness": 100.0}
    page.fill("#case-loads-obstacles", json.dumps([{**ball, "radius": 0}]))
    page.wait_for_selector("#case-loads-obstacles-told .fault")
    assert page.locator(".verdict .fault").inner_text() == "loads.obstacles.0.radius must be > 0"
    page.fill("#case-loads-obstacles", json.dumps([ball]))
    page.wait_for_selector(".preview .key-obstacle")
    assert asked[-1]["loads"]["obstacles"] == [ball]


def test_a_case_is_submitted_and_its_job_opened(form, page, registry):
    form("case=elastica")
    page.fill("#case-t_end", "2")
    page.fill("#page [name=label]", "mine")
    page.wait_for_selector("#submit:not([disabled])")
    page.click("#submit")
    page.wait_for_selector("#page .status")
    job = registry.get(page.url.rpartition("/")[2])
    assert (job.label, registry.case(job.id)["t_end"]) == ("mine", 2.0)


def test_a_job_is_run_again_with_changes(server, add, page):
    page.goto(f"{server.address}/#/jobs/{add(1)[0]}")
    page.click("text=Rerun with changes")
    page.wait_for_selector(".verdict .cost")
    assert page.input_value("#case-name") == "elastica"
    assert page.input_value("#case-t_end") == "30"


def test_the_preview_shows_the_rod_its_ends_and_its_loads(form, page):
    form("case=elastica")
    assert page.inner_text(".preview p") == "start: clamp, end: free"
    page.fill("#case-ends-end", "pin")
    page.wait_for_function("() => document.querySelector('.preview p').innerText === 'start: clamp, end: pin'")
    form("case=goyal-2003")
    page.wait_for_function("told => document.querySelector('.preview p').innerText === told",
                           arg="start: clamp with omega3, end: slider with switches")
    form("case=static-elastica")
    page.fill("#case-ends-end", json.dumps({"preset": "free", "mass": 2.0}))
    page.wait_for_function("told => document.querySelector('.preview p').innerText === told",
                           arg="start: clamp, end: free with a body of 2 kg")

"""The jobs table and the login page, in a browser."""

from __future__ import annotations

import pytest

from service.access import Scope
from service.api import documentation

CONTRASTS = """() => {
  const channels = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const light = (colour) => channels(colour).slice(0, 3).map(c => c / 255)
    .map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
    .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const ground = (node) => { for (; node; node = node.parentElement) {
    const colour = getComputedStyle(node).backgroundColor, parts = channels(colour);
    if (parts.length < 4 || parts[3] > 0) return colour; } return "rgb(255, 255, 255)"; };
  return [...document.querySelectorAll("body *")]
    .filter(node => node.checkVisibility() && [...node.childNodes].some(one => one.nodeType === 3 && one.data.trim()))
    .map(node => { const [a, b] = [light(getComputedStyle(node).color), light(ground(node))];
      return [(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), node.textContent.trim().slice(0, 40)]; });
}"""
ROWS = "#jobs tbody tr"


def rows(page, many):
    page.wait_for_function("([where, many]) => document.querySelectorAll(where).length === many", arg=[ROWS, many])


def test_a_wrong_key_is_refused_on_the_page_and_a_right_one_opens_it(keyed_server, page):
    asked = []
    page.on("dialog", lambda dialog: (asked.append(dialog.message), dialog.dismiss()))
    page.goto(keyed_server.address + "/#/?status=failed")
    page.wait_for_selector("#login:not([hidden])")
    page.wait_for_function("() => document.querySelector('#health').innerText !== 'asking'")
    assert page.is_hidden("#notice")  # nobody has done anything wrong yet
    page.fill("#login input", "hk_wrong")
    page.click("#login button")
    page.wait_for_selector("#notice:not([hidden])")
    assert page.inner_text("#notice").startswith("This key was refused: ")
    page.wait_for_selector("#login:not([hidden])")
    new = keyed_server.app.state.parts.keys.create("alice", frozenset({Scope.READ}), 3600.0)
    page.fill("#login input", new.text)
    page.click("#login button")
    page.wait_for_selector("#jobs:not([hidden])")
    page.wait_for_selector("#login", state="hidden")
    assert (page.input_value("[name=status]"), asked) == ("failed", [])


def test_ten_thousand_jobs_are_reached_page_by_page_and_by_search(server, add, page):
    oldest = add(1, "the oldest")[0]
    add(9999)
    page.goto(server.address)
    rows(page, 50)
    for many in (100, 150, 200, 250, 300):
        page.click("#more")
        rows(page, many)
    page.fill("[name=search]", "the oldest")
    rows(page, 1)
    assert page.locator(ROWS).get_attribute("id") == oldest


def test_filters_are_in_the_address(server, add, page):
    add(3, label="sweep")
    add(2)
    page.goto(server.address)
    rows(page, 5)
    page.fill("[name=label]", "sweep")
    rows(page, 3)
    assert page.url.endswith("#/?label=sweep")
    page.reload()
    rows(page, 3)
    page.select_option("[name=status]", "failed")
    rows(page, 0)


def test_days_bound_the_table_the_last_not_included(server, add, page):
    add(2)
    page.goto(server.address)
    rows(page, 2)
    today, tomorrow = page.evaluate("[0, 864e5].map((more) => new Date(Date.now() + more).toLocaleDateString('sv'))")
    for field, day, many in (("since", tomorrow, 0), ("since", today, 2), ("until", today, 0), ("until", tomorrow, 2)):
        page.fill(f"[name={field}]", day)
        rows(page, many)
    assert page.url.endswith(f"#/?since={today}&until={tomorrow}")


def test_columns_show_what_differs_between_the_cases(server, run, page):
    quick = {"output__interval": 0.25, "numerics__intervals": 10}
    ids = [run("cantilever-vibration", t_end=end, loads__damping=2 * end, **quick) for end in (0.5, 1.0)]
    page.goto(server.address)
    rows(page, 2)
    assert page.locator("#jobs th.value").count() == 0
    page.check("#differing")
    page.wait_for_selector("#jobs th.value")
    assert page.locator("#jobs th.value").all_inner_texts() == ["loads.damping", "t_end"]
    assert page.locator(f"#jobs tr[id='{ids[1]}'] .value").all_inner_texts() == ["2", "1"]
    page.uncheck("#differing")
    page.wait_for_selector("#jobs th.value", state="detached")
    assert page.locator("#jobs td.value").count() == 0


def test_new_jobs_appear_and_go_to_the_top(server, add, page):
    add(2)
    page.goto(server.address)
    rows(page, 2)
    newest = add(1, "new")[0]
    rows(page, 3)
    assert page.locator(ROWS).first.get_attribute("id") == newest


def test_a_job_is_cancelled_only_after_a_question(server, add, registry, page):
    job_id = add(1)[0]
    page.goto(server.address)
    page.click("text=Cancel >> visible=true")
    page.click("#ask button[value=no]")
    assert registry.get(job_id).status == "accepted"
    page.click(f"#jobs tr[id='{job_id}'] button")
    page.click("#ask button[value=yes]")
    page.wait_for_selector(f"#jobs tr[id='{job_id}'] .dismissed")
    assert registry.get(job_id).status == "dismissed"


def test_an_ended_job_is_deleted_only_after_a_question(server, add, registry, page):
    kept, gone = add(2)
    for job_id in (kept, gone):
        registry.cancel(job_id)
    page.goto(server.address)
    page.click(f"#jobs tr[id='{kept}'] button:has-text('Delete')")
    page.click("#ask button[value=no]")
    page.click(f"#jobs tr[id='{gone}'] button:has-text('Delete')")
    page.click("#ask button[value=yes]")
    rows(page, 1)
    assert registry.get(kept).id == kept
    page.reload()
    rows(page, 1)
    assert page.locator(ROWS).get_attribute("id") == kept


def test_keys_lead_to_a_job_and_its_address_opens_it_again(server, add, page):
    add(2)
    page.goto(server.address)
    rows(page, 2)
    newest = page.locator(ROWS).first.get_attribute("id")
    page.keyboard.press("j")
    page.keyboard.press("Enter")
    page.wait_for_selector("#page h2")
    assert page.url.endswith(f"#/jobs/{newest}")
    page.reload()
    page.wait_for_selector("#page h2")
    assert newest in page.text_content("#page dl")
    page.go_back()
    rows(page, 2)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_text_stands_out_from_its_ground(server, add, page, scheme):
    add(2)
    page.emulate_media(color_scheme=scheme)
    page.goto(server.address)
    rows(page, 2)
    found = page.evaluate(CONTRASTS)
    assert len(found) > 20
    assert [one for one in found if one[0] < 4.5] == []


def test_nothing_is_wider_than_a_phone(server, add, page):
    add(2, label="a" * 60)
    page.set_viewport_size({"width": 360, "height": 800})
    page.goto(server.address)
    rows(page, 2)
    assert page.evaluate("document.documentElement.scrollWidth") <= 360


@pytest.mark.parametrize("built", [True, False])
def test_the_documentation_is_a_click_away_where_it_is_built(server, page, tmp_path, monkeypatch, built):
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "index.html").write_text("<title>documentation</title>")
    monkeypatch.setattr(documentation, "SITE", tmp_path / ("site" if built else "none"))
    with page.expect_response("**/docs/") as asked:
        page.goto(server.address)
    asked.value.finished()
    page.wait_for_function("built => document.querySelector('#docs').hidden !== built", arg=built)
    if built:
        page.click("#docs")
        page.wait_for_function("() => document.title === 'documentation'")


def test_the_page_tells_of_the_loss_of_its_server_and_of_its_return(server, add, page):
    add(1)
    page.goto(server.address)
    rows(page, 1)
    page.route("**/v1/**", lambda route: route.abort())
    page.wait_for_selector("#notice:not([hidden])")
    page.unroute("**/v1/**")
    page.wait_for_selector("#notice", state="hidden")

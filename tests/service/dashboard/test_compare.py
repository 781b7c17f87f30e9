"""Several runs beside each other, in a browser."""

from __future__ import annotations

QUICK = {"output__interval": 0.1, "numerics__intervals": 20}


def test_runs_are_chosen_in_the_table_and_compared_on_one_clock(server, run, page):
    ids = [run("cantilever-vibration", t_end=end, **QUICK) for end in (1.0, 2.0, 1.5)]
    page.goto(server.address)
    for job_id in ids[:2]:
        page.check(f"#jobs tr[id='{job_id}'] input")
    page.click("text=Compare 2 runs")
    page.wait_for_selector(".player:not([hidden])")
    page.wait_for_selector("#page .chart")
    assert page.url.endswith(f"#/compare?jobs={','.join(sorted(ids[:2]))}")
    assert page.inner_text(".clock output") == "t = 2 s"  # the longer one's end
    for legend in page.locator("#page .legend").all_inner_texts():
        assert "A" in legend and "B" in legend
    assert page.locator("#page .wide tbody tr").all_inner_texts() == ["t_end\t1\t2"]
    page.reload()
    page.wait_for_selector(".player:not([hidden])")
    assert page.locator("#page .runs li").count() == 2


def test_each_run_has_a_colour_of_its_own(server, run, page):
    ids = [run("elastica", t_end=end, output__interval=0.5, numerics__intervals=20) for end in (1.0, 6.0)]
    page.goto(f"{server.address}/#/compare?jobs={','.join(ids)}")
    page.wait_for_selector(".player:not([hidden])")
    colours = page.evaluate("[...document.querySelectorAll('.runs a')].map(one => getComputedStyle(one).color)")
    assert len(set(colours)) == 2


def test_more_than_six_runs_are_refused(server, add, page):
    ids = add(7)
    page.goto(server.address)
    for job_id in ids:
        page.check(f"#jobs tr[id='{job_id}'] input")
    assert page.inner_text("#compare") == "At most 6 runs can be compared"
    assert page.is_disabled("#compare")

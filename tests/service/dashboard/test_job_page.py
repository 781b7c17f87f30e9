"""The page of a job, in a browser."""

from __future__ import annotations

from urllib.request import urlopen

QUICK = {"t_end": 1.0, "output__interval": 0.1, "numerics__intervals": 20}


def shown(page, server, job_id):
    page.goto(f"{server.address}/#/jobs/{job_id}")
    page.wait_for_selector("#page h2")


def legend(page, title):
    return page.locator("#page figure", has_text=title).locator(".legend").inner_text()


def test_the_curves_of_a_run_are_drawn_with_their_last_values(server, run, page):
    shown(page, server, run("goyal-2003", **QUICK))
    page.wait_for_selector("#page .chart")
    titles = [one.partition(" (")[0] for one in page.locator("#page figcaption").all_inner_texts()]
    assert titles == ["Twist, writhe, link", "Defect Tw + Wr - Lk", "Energies", "Energy balance, 0 if exact",
                      "Tension at the ends", "Largest curvature", "Step dt", "Newton iterations of the step"]
    assert "torsion" in legend(page, "Energies") and "potential" not in legend(page, "Energies")  # it has no weight
    assert "s = 0" in legend(page, "Tension") and "s = L" not in legend(page, "Tension")  # that end slides freely


def test_what_is_noise_is_not_drawn_and_potential_energy_counts_from_the_start(server, run, page):
    shown(page, server, run("hanging-cable", **QUICK))
    page.wait_for_selector("#page .chart")
    titles = page.locator("#page figcaption").all_inner_texts()
    assert not [one for one in titles if "turns" in one]  # it lies in a plane
    assert "Energies (mJ)" in titles  # but from the lab's zero its potential energy is -50 J
    assert "potential, from its start" in legend(page, "Energies")
    assert "s = 0" in legend(page, "Tension") and "s = L" in legend(page, "Tension")


def test_a_running_job_is_drawn_as_its_frames_come(server, add, page):
    job_id, frames = add(1)[0], [2]

    def running(route):
        now = {"status": "running", "phase": "running", "progress": 0.4, "remaining": 90}
        route.fulfill(json=route.fetch().json() | now)

    def data(route):
        names = route.request.url.split("variables=")[1].split("&")[0].split(",")
        time = [0.25 * k for k in range(frames[0])]
        value = {"f": [[[0.0, 0.0, 1.0]] for _ in [*time, "one that came meanwhile"]]}
        route.fulfill(json={"coordinates": {"time": {"values": time}}, "variables": {
            name: {"units": "1", "values": value.get(name, time)} for name in names}})

    here = f"{server.address}/v1/jobs/{job_id}"
    page.route(here, running)
    page.route(f"{here}/data?*", data)
    shown(page, server, job_id)
    page.wait_for_function("() => document.querySelector('#page .legend')?.innerText.includes('Tw 0.25')")
    assert "running, t = 0.00 s, 1 min 30 s left" in page.inner_text("#page")
    frames[0] = 5
    page.wait_for_function("() => document.querySelector('#page .legend').innerText.includes('Tw 1')")
    assert page.locator("#page .chart path[d*=NaN]").count() == 0


def test_the_outcome_comes_with_its_remedy(server, add, page):
    job_id = add(1)[0]
    page.route(f"{server.address}/v1/jobs/{job_id}", lambda route: route.fulfill(json=route.fetch().json() | {
        "status": "failed", "outcome": "newton_stalled", "message": "use shorter steps"}))
    shown(page, server, job_id)
    assert page.inner_text("#page .outcome") == "newton_stalled: use shorter steps"


def test_what_differs_from_the_shipped_case_is_listed(server, run, page):
    shown(page, server, run("cantilever-vibration", **QUICK))
    page.wait_for_selector("#page table")
    rows = [row.split("\t") for row in page.locator("#page table tbody tr").all_inner_texts()]
    assert ["numerics.intervals", "20", "60"] in rows
    assert sorted(row[0] for row in rows) == ["numerics.intervals", "t_end"]


def test_a_waiting_job_tells_how_many_go_first(server, add, page):
    shown(page, server, max(add(3)))
    assert page.inner_text("#page .status") == "accepted: 2 jobs of local first"


def test_a_share_link_opens_the_dataset(server, run, page):
    shown(page, server, run("cantilever-vibration", **QUICK))
    page.click("text=Share link")
    address = page.get_attribute("#page .shared a", "href")
    with urlopen(address) as answer:
        assert answer.read(4) == b"\x89HDF"


def test_dataset_and_case_are_saved(server, run, page):
    job_id = run("cantilever-vibration", **QUICK)
    shown(page, server, job_id)
    for label, name in (("Dataset", f"{job_id}.nc"), ("Case file", f"{job_id}.json")):
        with page.expect_download() as saved:
            page.click(f"#page button:has-text('{label}')")
        assert saved.value.suggested_filename == name

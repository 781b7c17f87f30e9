"""The page of a job, in a browser."""

from __future__ import annotations


def test_twist_writhe_link_and_their_defect_are_drawn(server, add, page):
    here = f"/v1/jobs/{add(1)[0]}"
    values = {"Tw": [0.0, 1.0, 2.0], "Wr": [0.0, 0.5, None], "Lk": [0.0, 1.5, 2.5]}
    data = {"coordinates": {"time": {"units": "s", "values": [0.0, 1.0, 2.0]}},
            "variables": {name: {"units": "turn", "values": curve} for name, curve in values.items()}}

    def ended(route):
        job = route.fetch().json()
        route.fulfill(json=job | {"status": "successful", "dataset": {"href": f"{here}/dataset", "bytes": 1}})

    page.route(server.address + here, ended)
    page.route(f"{server.address}{here}/data?*", lambda route: route.fulfill(json=data))
    page.goto(f"{server.address}/#{here.removeprefix('/v1')}")
    page.wait_for_function("() => document.querySelectorAll('#job .chart').length === 2")
    assert page.locator("#job .legend").all_inner_texts() == ["TwWrLk", "Tw + Wr - Lk"]
    counts = [len(line.get_attribute("points").split()) for line in page.locator("#job polyline").all()]
    assert counts == [3, 2, 3, 2]

"""No page asks for what is not there."""

from __future__ import annotations


def test_no_request_of_a_page_is_refused(server, run, page):
    refused, site = [], f"{server.address}/docs/"  # which is asked for to know whether it was built
    page.on("response", lambda answer: refused.append(answer.url) if answer.status >= 400 else None)
    ids = [run("elastica", t_end=1.0), run("hanging-cable"), run("elastica", loads__gravity=[0.0, 0.0, -1e9])]
    for path in ("", *(f"jobs/{one}" for one in ids), f"compare?jobs={','.join(ids)}", "new", "ensembles"):
        page.goto(f"{server.address}/#/{path}")
        page.wait_for_load_state("networkidle")
    assert set(refused) <= {site}

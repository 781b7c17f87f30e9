"""The film of a cable, in a browser that draws WebGL by software."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

BENT = {"t_end": 6.0, "output__interval": 0.5, "numerics__intervals": 40}


@pytest.fixture
def film(server, run, page):
    """The page with the film of a cantilever that bends."""
    page.goto(f"{server.address}/#/jobs/{run('elastica', **BENT)}")
    page.wait_for_selector(".player:not([hidden])")
    return page


def seen(page) -> np.ndarray:
    """The picture's pixels, (rows, columns, 3)."""
    page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return matplotlib.image.imread(BytesIO(page.locator(".stage").screenshot()))[..., :3]


def scrub(page, t):
    page.evaluate("t => { const s = document.querySelector('.clock input'); s.value = t; s.oninput() }", t)


def orange(pixels: np.ndarray) -> np.ndarray:
    return (pixels[..., 0] > pixels[..., 1] + 0.05) & (pixels[..., 1] > pixels[..., 2] + 0.12)


def blue(pixels: np.ndarray) -> np.ndarray:
    return (pixels[..., 2] > pixels[..., 0] + 0.05) & (pixels[..., 2] < 0.5)


def test_the_cable_is_drawn_with_a_stripe_and_moves_when_it_is_scrubbed(film):
    scrub(film, 0.0)
    start = seen(film)
    scrub(film, 6.0)
    end = seen(film)
    for pixels in (start, end):
        assert orange(pixels).sum() > 500
    straight, bent = (np.nonzero(orange(pixels)) for pixels in (start, end))
    assert np.ptp(bent[0]) > 3 * np.ptp(straight[0])  # it lies at first, and then hangs
    assert film.inner_text(".clock output") == "t = 6 s"


def test_colours_have_a_scale_with_units(film):
    options = film.locator("[name=colour] option").all_inner_texts()
    assert options == ["none", "curvature", "twist", "tension"]
    plain = seen(film)
    film.select_option("[name=colour]", "curvature")
    assert film.inner_text(".scale").endswith("rad/m")
    coloured = seen(film)
    assert orange(coloured).sum() < 0.2 * orange(plain).sum()


def test_a_verified_run_is_coloured_by_its_error(server, run, page):
    page.goto(f"{server.address}/#/jobs/{run('elastica', **BENT, numerics__verify=True)}")
    page.wait_for_selector(".player:not([hidden])")
    plain = seen(page)
    page.select_option("[name=colour]", "error")
    low, high, unit = page.inner_text(".scale").split()
    assert (float(low), unit) == (0.0, "m") and 0.0 < float(high) < 0.1  # nothing is wrong where it is clamped
    assert orange(seen(page)).sum() < 0.2 * orange(plain).sum()


FLOOR = {"stiffness": 100.0, "normal": [-1.0, 0.0, 0.0], "height": -0.5, "friction": 0.3}
LINES = """async (shape) => {
  const { Surroundings } = await import("/dashboard/cable/surroundings.js");
  const { lines } = new Surroundings([shape], [[0, 0, 0], [0.5, 0, 1]], [-1, 0, 0]), heights = [];
  for (let k = 0; k < lines.length; k += 7) if (Math.abs(lines[k + 3] - 0.55) < 1e-6) heights.push(lines[k]);
  return heights;
}"""


def test_a_floor_is_drawn_where_it_lies(server, run, page):
    pictures = []
    for more in ({}, {"loads__floor": FLOOR}):
        page.goto(f"{server.address}/#/jobs/{run('elastica', **BENT, **more)}")
        page.wait_for_selector(".player:not([hidden])")
        pixels = seen(page)
        pictures.append((pixels[..., 0] > pixels[..., 2] + 0.08) & ~orange(pixels))
    without, with_floor = pictures
    assert with_floor.sum() > without.sum() + 1000  # the floor is brown, the ground of a scene without one is grey
    heights = page.evaluate(LINES, {"loads": {"floor": FLOOR}})
    assert len(heights) > 20 and set(heights) == {0.5}


BAR = {"start": [0.15, -50.0, 0.8], "end": [0.15, 50.0, 0.8], "radius": 0.06, "stiffness": 1e3}
BALL = {"start": [0.3, 0.0, 0.6], "radius": 0.15, "stiffness": 1e3}
HILL = {"start": [-50.1, 0.0, 0.3], "radius": 50.0, "stiffness": 1e3}
ROD = [[0, 0, 0], [0.5, 0, 1]]
SURFACE = """async ([obstacles, rod]) => {
  const { Obstacles, CORNER } = await import("/dashboard/cable/obstacles.js");
  const { triangles, box, far } = new Obstacles(obstacles, rod);
  return { corners: [...triangles], floats: CORNER, box, far };
}"""


def surface(page, *obstacles):
    """Triangles (m, 3, 3) of what is drawn, their normals, and how far they are faded in (m, 3); and the box of all."""
    got = page.evaluate(SURFACE, [obstacles, ROD])
    corners = np.array(got["corners"]).reshape(-1, 3, got["floats"])
    return corners[..., :3], corners[..., 3:6], corners[..., 6], np.array(got["box"])


@pytest.mark.parametrize("obstacle", [BAR, BALL, HILL])
def test_the_surface_of_an_obstacle_lies_where_it_does(server, page, obstacle):
    page.goto(server.address)
    places, normals, shown, box = surface(page, obstacle)
    start = np.array(obstacle["start"])
    way = np.array(obstacle.get("end", obstacle["start"])) - start
    part = np.clip((places - start) @ way / max(way @ way, 1e-300), 0.0, 1.0)
    away = places - start - part[..., None] * way
    assert len(places) > 500
    assert np.linalg.norm(away, axis=-1) == pytest.approx(obstacle["radius"], abs=5e-6)  # 4-byte floats
    assert np.abs(away / obstacle["radius"] - normals).max() < 1e-4
    sides = places[:, 1:] - places[:, :1]
    turned = (np.cross(sides[:, 0], sides[:, 1]) * normals.mean(axis=1)).sum(axis=1)
    assert (turned > -1e-9).all() and (turned > 0).mean() > 0.9  # seen from outside they go round to the left
    assert (places[shown > 0] >= box[0] - 1e-6).all() and (places[shown > 0] <= box[1] + 1e-6).all()
    assert (box[0] > -0.52).all() and (box[1] < 1.52).all()  # not more than half a rod around the rod
    assert ((shown == 1).all()) == (obstacle is BALL)  # what goes on is faded out


def test_an_obstacle_that_is_far_from_the_rod_is_told_and_not_drawn(server, page):
    page.goto(server.address)
    got = page.evaluate(SURFACE, [[{**BALL, "start": [5.0, 0.0, 0.0]}, BALL], ROD])
    assert got["far"] == 1 and got["box"][1][0] == pytest.approx(0.5, abs=1e-6)


def grey(pixels: np.ndarray) -> np.ndarray:
    """The surface of an obstacle; the ground's lines are lighter, and its shadow is thin."""
    return (pixels.max(axis=-1) < 0.74) & (pixels[..., 2] > pixels[..., 0] + 0.04) & (pixels[..., 0] > 0.3)


def test_obstacles_are_seen_and_said_and_do_not_shrink_the_cable(server, run, page):
    wide, dark = [], []
    for more in ({}, {"loads__obstacles": [BAR, BALL]}):
        page.goto(f"{server.address}/#/jobs/{run('elastica', **BENT, **more)}")
        page.wait_for_selector(".player:not([hidden])")
        pixels = seen(page)
        wide.append(np.ptp(np.nonzero(orange(pixels))[1]))
        dark.append(grey(pixels).sum())
        assert page.locator(".key-obstacle").count() == len(more)
    assert dark[1] > dark[0] + 5000
    assert wide[1] > 0.4 * wide[0]


def test_where_the_cable_is_pressed_on_an_obstacle_or_a_floor_is_marked(server, run, page):
    for more in ({"loads__obstacles": [BAR]}, {"loads__floor": {**FLOOR, "height": -0.3}}):
        page.goto(f"{server.address}/#/jobs/{run('elastica', **BENT, **more)}")
        page.wait_for_selector(".player:not([hidden])")
        page.wait_for_function("() => Number(document.querySelector('.player').dataset.contacts) > 0")
        scrub(page, 0.0)
        page.wait_for_function("() => document.querySelector('.player').dataset.contacts === '0'")


def test_runs_beside_each_other_are_drawn_with_the_obstacles_of_all(server, run, page):
    ids = [run("elastica", **BENT), run("elastica", **BENT, loads__obstacles=[BALL])]
    page.goto(f"{server.address}/#/compare?jobs={','.join(ids)}")
    page.wait_for_selector(".player:not([hidden]) .key-obstacle")
    assert grey(seen(page)).sum() > 3000


AROUND = """async (shapes) => {
  const { Stage } = await import("/dashboard/cable/stage.js");
  const stage = new Stage("");
  stage.set(shapes, [[0, 0, 0], [1, 0, 0.2]], [1, 0, 0]);
  const { grounds, weights, currents, up } = stage.surroundings, shadows = shapes.map((shape) => {
    const lines = [];
    stage.surroundings.shadow(shape, new Float32Array(16).fill(0.1), lines);
    return lines[2];
  });
  const legend = stage.legend.innerText;
  stage.close();
  return { grounds, weights, currents, up, shadows, legend };
}"""


def test_runs_beside_each_other_have_the_floors_weights_and_currents_of_all(server, page):
    page.goto(server.address)
    low, high = ({"loads": {"floor": {"height": height}, "gravity": [0, 0, -9.81]}} for height in (-1, -0.5))
    flows = {"loads": {"gravity": [0, 0, -1.62]}, "fluid": {"current": [0.5, 0, 0]}}
    got = page.evaluate(AROUND, [{"loads": {}}, low, high, low, flows])
    assert [ground["height"] for ground in got["grounds"]] == [-1, -0.5]
    assert (got["weights"], got["currents"], got["up"]) == ([[0, 0, -1]], [[1, 0, 0]], [0, 0, 1])
    assert got["shadows"] == pytest.approx([-1, -1, -0.5, -1, -1], abs=2e-3)
    assert all(name in got["legend"] for name in ("floor", "weight", "current"))


FOLLOWED = """async (ball) => {
  const { Stage } = await import("/dashboard/cable/stage.js");
  const stage = new Stage(""), shape = { loads: { obstacles: [ball] } }, seen = [];
  document.body.append(stage.canvas);
  const look = () => seen.push([stage.camera.distance, stage.surroundings.obstacles.triangles.length > 0]);
  stage.set([shape], [[0, 0, 0], [0.1, 0, 0]], [1, 0, 0]);
  look();
  stage.follow([shape], [[0, 0, -0.3], [0.1, 0, 0]]);
  look();
  stage.zoom(0.5);
  stage.follow([shape], [[0, 0, -0.9], [0.1, 0, 0]]);
  look();
  stage.fit();
  look();
  stage.close();
  return seen;
}"""


def test_a_run_that_goes_on_stays_in_the_picture_unless_it_was_moved(server, page):
    page.goto(server.address)
    first, widened, moved, whole = page.evaluate(FOLLOWED, {**BALL, "start": [0.0, 0.0, -1.0], "radius": 0.1})
    assert [drawn for _, drawn in (first, widened, moved)] == [False, False, True]
    assert widened[0] > 2 * first[0]
    assert moved[0] == pytest.approx(widened[0] / 2)
    assert whole[0] > widened[0]


def test_views_differ_and_the_pointer_turns_the_cable(film):
    pictures, stripe = [seen(film)], []
    for view in ("along e1", "along e2", "along e3", "free"):
        film.select_option("[name=view]", view)
        pictures.append(seen(film))
        stripe.append(blue(pictures[-1]).sum())
    assert max(stripe) > 500  # along a1, which one of the views faces
    box = film.locator(".stage").bounding_box()
    film.mouse.move(box["x"] + 200, box["y"] + 200)
    film.mouse.down()
    film.mouse.move(box["x"] + 400, box["y"] + 150, steps=3)
    film.mouse.up()
    pictures.append(seen(film))
    assert np.abs(pictures[0] - pictures[4]).max() < 0.02  # the first view again
    for k in (1, 2, 3, 5):
        assert np.abs(pictures[k] - pictures[0]).max() > 0.3


def test_it_plays_to_its_end_and_marks_its_time_in_the_curves(film):
    scrub(film, 0.0)
    film.wait_for_selector("#page .chart")
    film.locator(".stage").press(".")
    film.wait_for_function("() => document.querySelector('.clock output').innerText === 't = 0.5 s'")
    before = film.locator("#page .legend").all_inner_texts()
    film.select_option(".clock select", "5 s")
    film.click(".clock button")
    film.wait_for_function("() => document.querySelector('.clock output').innerText === 't = 6 s'")
    film.wait_for_function("() => document.querySelector('.clock button').innerText === 'Play'")
    assert film.locator("#page .legend").all_inner_texts() != before


def test_no_curve_is_drawn_anew_as_the_time_changes(film):
    film.wait_for_selector("#page .chart")
    film.evaluate("""() => {
      window.drawn = [];
      const watch = new MutationObserver((seen) => window.drawn.push(...seen));
      document.querySelectorAll("svg.chart").forEach((one) => watch.observe(one, {
        attributes: true, childList: true, characterData: true, subtree: true }));
    }""")
    places = []
    for t in (0.0, 3.0, 6.0):
        scrub(film, t)
        box, plot = (film.locator(f"#page {one}").first.bounding_box() for one in (".marker", ".plot"))
        places.append((box["x"] - plot["x"]) / plot["width"])
    assert film.evaluate("() => new Promise(done => setTimeout(() => done(window.drawn.length)))") == 0
    assert places == pytest.approx([56 / 480, (56 + 468) / 2 / 480, 468 / 480], abs=2e-3)  # of what the axes span


def test_a_picture_is_saved_as_it_is_seen(film, tmp_path: Path):
    with film.expect_download() as saved:
        film.click("text=PNG")
    saved.value.save_as(tmp_path / "cable.png")
    assert saved.value.suggested_filename == "elastica-6s.png"
    assert orange(matplotlib.image.imread(tmp_path / "cable.png")).sum() > 500


def test_a_video_is_recorded(film, tmp_path: Path):
    film.select_option(".clock select", "5 s")
    with film.expect_download() as saved:
        film.click("#video")
    saved.value.save_as(tmp_path / "cable")
    content = (tmp_path / "cable").read_bytes()
    kind = Path(saved.value.suggested_filename).suffix
    assert {".mp4": content[4:8] == b"ftyp", ".webm": content[:4] == b"\x1aE\xdf\xa3"}[kind]
    assert len(content) > 20_000


def test_contacts_are_marked_where_strands_touch(server, run, page):
    job_id = run("short-loop", t_end=0.8, output__interval=0.1)
    page.goto(f"{server.address}/#/jobs/{job_id}")
    page.wait_for_selector(".player:not([hidden])")
    page.wait_for_function("() => Number(document.querySelector('.player').dataset.contacts) > 0")


def test_without_webgl_the_page_says_so_and_shows_the_curves(server, run, page):
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(f"{server.address}/#/jobs/{run('elastica', **BENT)}")
    page.wait_for_selector("#page .chart")
    assert "this browser has no WebGL 2" in page.inner_text("#page")

// @ts-check
/** A film of one run: the cable in 3-D with a clock, colours, views, and its export. */
import { button, element } from "../page.js";
import { told } from "../scale.js";
import { Clock } from "./clock.js";
import { Film, NODE } from "./film.js";
import { SCALE } from "./picture.js";
import { picture, video } from "./record.js";
import { Stage, VIEWS } from "./stage.js";
import { diameter, pressed, touching } from "./surroundings.js";

/** A run: the address of its job, and its case. @typedef {{job: string, shape: any}} Run */
const BODY = [0.93, 0.62, 0.2], SEEN = 0.005;

export class Player {
  /** @param {Run[]} runs on one clock @param {(t: number) => void} tell of the time shown
   * @param {(place: number) => number[]} [body] the colour of each run's cable */
  constructor(runs, tell, body = () => BODY) {
    this.runs = runs.map((run) => ({ ...run, film: new Film(), nodes: new Float32Array(0) }));
    this.shapes = runs.map(({ shape }) => shape);
    this.body = body;
    this.stage = new Stage(`cable in three dimensions: ${this.shapes.map(({ title, name }) => title || name).join("; ")}`);
    this.stage.content = () => this.content();
    this.clock = new Clock((t) => {
      this.stage.redraw();
      tell(t);
    });
    this.legend = element("span", "scale");
    this.place = element("section", "player", this.stage.canvas, this.stage.legend, this.clock.place, this.controls());
    this.place.hidden = true;
    this.place.setAttribute("aria-label", "The cable in three dimensions");
    this.stage.canvas.addEventListener("keydown", (event) => this.clock.key(event));
  }

  controls() {
    this.colour = choice("Colour", ["none"], () => this.paint());
    this.view = choice("View", Object.keys(VIEWS), () => this.stage.look(this.view?.value ?? "free"));
    this.thick = /** @type {HTMLInputElement} */ (document.createElement("input"));
    this.thick.type = "checkbox";
    this.thick.onchange = () => this.stage.redraw();
    const still = button("PNG", () => picture(this.stage, this.name("png")));
    const moving = button("Video", () => video(this.stage, this.clock, (kind) => this.name(kind)));
    moving.id = "video";
    const colours = this.runs.length === 1 ? [labelled("Colour", this.colour), this.legend] : [];
    return element("div", "controls", ...colours, labelled("View", this.view),
      labelled("True thickness", this.thick), still, moving);
  }

  /** @param {string} kind */
  name(kind) {
    return `${this.shapes[0].name || "cable"}-${told(this.clock.t)}s.${kind}`;
  }

  /** The film whose colours are offered. */
  get film() {
    return this.runs[0].film;
  }

  /** Read the films from their beginning again: a run has ended, and may have been refined. */
  again() {
    for (const run of this.runs) run.film.clear();
    return this.more();
  }

  /** Read what is new of the runs; says whether there is a film by now. */
  async more() {
    const first = this.place.hidden;
    const news = await Promise.all(this.runs.map(({ film, job }) => film.more(job)));
    const shown = this.runs.filter(({ film }) => film.time.length);
    if (news.some(Boolean)) {
      for (const run of shown) run.nodes = new Float32Array(NODE * run.film.nodes);
      if (first) this.open(shown);
      else this.stage.follow(this.shapes, boxOf(shown));
      const longest = shown.reduce((best, run) => end(run) > end(best) ? run : best);
      this.clock.set(longest.film.time);
      this.paint();
    }
    return shown.length > 0;
  }

  /** @param {{film: Film}[]} shown */
  open(shown) {
    this.place.hidden = false;
    const names = [...(this.colour?.options ?? [])].map((one) => one.value);
    this.colour?.append(...this.film.colours.filter((name) => !names.includes(name)).map((name) => new Option(name)));
    const { film } = shown[0], r = film.values("r"), last = 3 * (film.nodes - 1);
    this.stage.set(this.shapes, boxOf(shown), [0, 1, 2].map((i) => r[last + i] - r[i]));
  }

  /** Show the chosen colour and its scale. */
  paint() {
    const name = this.colour?.value ?? "none", block = this.film.blocks.get(name);
    this.range = block ? this.film.range(name) : null;
    const bar = element("i", "");
    bar.style.background = `linear-gradient(to right, ${SCALE.map((one) => `rgb(${one.map((x) => Math.round(255 * x))})`).join()})`;
    this.legend.replaceChildren(...(this.range ? [told(this.range[0], 3), bar, `${told(this.range[1], 3)} ${block?.units}`] : []));
    this.stage.redraw();
  }

  content() {
    const { t } = this.clock, colour = this.colour?.value ?? "none";
    /** @type {{rods: import("./picture.js").Rod[], lines: number[], points: number[]}} */
    const seen = { rods: [], lines: [], points: [] };
    this.runs.forEach(({ film, nodes, shape }, place) => {
      if (!film.time.length) return;
      film.at(t, colour, nodes);
      this.stage.surroundings?.shadow(shape, nodes, seen.lines);
      if (film.contacts[film.frame(t)] > 0) seen.points.push(...touching(nodes, film.s, shape));
      seen.points.push(...pressed(nodes, film.s, shape));
      seen.rods.push({ nodes, radius: this.radius(shape), body: this.body(place), range: this.range ?? null });
    });
    this.place.dataset.contacts = String(seen.points.length / 7);
    return seen;
  }

  /** @param {any} shape */
  radius(shape) {
    const real = diameter(shape) / 2;
    return this.thick?.checked ? real : Math.max(real, SEEN * (this.stage.surroundings?.extent ?? 1));
  }

  close() {
    this.clock.close();
    this.stage.close();
  }
}

/** The box of all frames of some runs. @param {{film: Film}[]} runs @returns {import("./obstacles.js").Box} */
function boxOf(runs) {
  /** @param {number} side @param {(...values: number[]) => number} most */
  const corner = (side, most) => [0, 1, 2].map((i) => most(...runs.map(({ film }) => film.box[side][i])));
  return [corner(0, Math.min), corner(1, Math.max)];
}

/** @param {{film: Film}} run */
const end = ({ film }) => film.time[film.time.length - 1];

/** @param {string} name @param {string[]} options @param {() => void} act */
export function choice(name, options, act) {
  const made = document.createElement("select");
  made.append(...options.map((one) => new Option(one)));
  made.name = name.toLowerCase();
  made.onchange = act;
  return made;
}

/** @param {string} text @param {HTMLElement} control */
export const labelled = (text, control) => element("label", "", `${text} `, control);

// @ts-check
/** A film of one run: the cable in 3-D with a clock, colours, views, and its export. */
import { button, element } from "../page.js";
import { told } from "../scale.js";
import { Clock } from "./clock.js";
import { Film, NODE } from "./film.js";
import { SCALE } from "./picture.js";
import { picture, video } from "./record.js";
import { Stage, VIEWS } from "./stage.js";
import { diameter, touching } from "./surroundings.js";

const BODY = [0.93, 0.62, 0.2], SEEN = 0.005;

export class Player {
  /** @param {string} job its address @param {any} shape its case @param {(t: number) => void} tell of the time shown */
  constructor(job, shape, tell) {
    this.job = job;
    this.shape = shape;
    this.film = new Film();
    this.stage = new Stage(`the cable of ${shape.title || shape.name} in three dimensions`);
    this.stage.content = () => this.content();
    this.clock = new Clock((t) => {
      this.stage.redraw();
      tell(t);
    });
    this.nodes = new Float32Array(0);
    this.legend = element("span", "scale");
    this.place = element("section", "player", this.stage.canvas, this.clock.place, this.controls());
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
    return element("div", "controls", labelled("Colour", this.colour), this.legend, labelled("View", this.view),
      labelled("True thickness", this.thick), still, moving);
  }

  /** @param {string} kind */
  name(kind) {
    return `${this.shape.name || "cable"}-${told(this.clock.t)}s.${kind}`;
  }

  /** Read the film from its beginning again: the run has ended, and may have been refined. */
  again() {
    this.film.clear();
    return this.more();
  }

  /** Read what is new of the run; says whether there is a film by now. */
  async more() {
    const first = !this.film.time.length;
    if (await this.film.more(this.job)) {
      if (first) this.open();
      this.clock.set(this.film.time);
      this.paint();
    }
    return this.film.time.length > 0;
  }

  open() {
    this.place.hidden = false;
    this.nodes = new Float32Array(NODE * this.film.nodes);
    const shown = [...(this.colour?.options ?? [])].map((one) => one.value);
    this.colour?.append(...this.film.colours.filter((name) => !shown.includes(name)).map((name) => new Option(name)));
    const r = this.film.values("r"), last = 3 * (this.film.nodes - 1);
    this.stage.set(this.shape, this.film.box, [0, 1, 2].map((i) => r[last + i] - r[i]));
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
    const { film, stage, shape } = this, { t } = this.clock;
    if (!film.time.length) return { rods: [], lines: [], points: [] };
    film.at(t, this.colour?.value ?? "none", this.nodes);
    /** @type {number[]} */
    const lines = [];
    stage.surroundings?.shadow(this.nodes, lines);
    const points = film.contacts[film.frame(t)] > 0 ? touching(this.nodes, film.s, shape) : [];
    this.place.dataset.contacts = String(points.length / 7);
    return { rods: [{ nodes: this.nodes, radius: this.radius(), body: BODY, range: this.range ?? null }], lines, points };
  }

  radius() {
    const real = diameter(this.shape) / 2;
    return this.thick?.checked ? real : Math.max(real, SEEN * (this.stage.surroundings?.extent ?? 1));
  }

  close() {
    this.clock.close();
    this.stage.close();
  }
}

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

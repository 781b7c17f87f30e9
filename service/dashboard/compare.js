// @ts-check
/** Two to six runs beside each other: their cables in one picture on one clock, their curves, what differs. */
import { read } from "./api.js";
import { Player } from "./cable/player.js";
import { Curves, series } from "./curves.js";
import { brief, differences } from "./difference.js";
import { byId, element, isOpen } from "./page.js";
import { table } from "./table.js";

/** @typedef {import("./api.js").Job} Job */
export const MOST = 6;

export class ComparePage {
  /** @param {URLSearchParams} chosen `jobs`: ids with commas between */
  constructor(chosen) {
    this.ids = (chosen.get("jobs") ?? "").split(",").filter(Boolean).slice(0, MOST);
    this.closing = new AbortController();
    this.curves = new Curves();
    this.names = element("ul", "runs");
    this.film = element("div", "");
    this.rest = element("div", "");
    byId("page").replaceChildren(element("h2", "", "Runs beside each other"), this.names, this.film, this.curves.place, this.rest);
    document.title = "hockle: comparison";
  }

  async fill() {
    /** @type {[Job, any][]} */
    const runs = await Promise.all(this.ids.map(async (id) => [await read(`/v1/jobs/${id}`), await read(`/v1/jobs/${id}/case`)]));
    if (this.closing.signal.aborted || !runs.length) return;
    this.jobs = runs.map(([job]) => job);
    this.shapes = runs.map(([, shape]) => shape);
    this.names.replaceChildren(...this.jobs.map((job, place) => {
      const link = /** @type {HTMLAnchorElement} */ (element("a", `line${place}`, `${this.label(place)}: ${job.title}`));
      link.href = `#/jobs/${job.id}`;
      return element("li", "", link, ` ${job.status}`);
    }));
    this.tellDifferences();
    try {
      const sources = this.shapes.map((shape, place) => ({ job: `/v1/jobs/${this.ids[place]}`, shape }));
      this.player = new Player(sources, (t) => this.curves.mark(t), (place) => this.colour(place));
      this.film.append(this.player.place);
    } catch (error) {
      this.film.append(element("p", "faint", /** @type {Error} */ (error).message));
    }
    await this.draw();
  }

  /** A short name of a run. @param {number} place */
  label(place) {
    return "ABCDEF"[place];
  }

  /** The colour of a run's name on the page, as its cable has it. @param {number} place */
  colour(place) {
    const link = this.names.children[place]?.firstElementChild;
    const parts = link ? getComputedStyle(link).color.match(/[\d.]+/g) ?? [] : [];
    return parts.slice(0, 3).map((one) => Number(one) / 255);
  }

  async draw() {
    const film = this.player?.more();
    const found = await Promise.all(this.ids.map((id, place) => series(`/v1/jobs/${id}`, this.shapes?.[place])));
    const told = found.flatMap((run, place) => run ? [[this.label(place), run]] : []);
    if (!this.closing.signal.aborted && told.length) this.curves.compare(Object.fromEntries(told));
    await film;
  }

  tellDifferences() {
    const [first, ...others] = this.shapes ?? [];
    const keys = [...new Set(others.flatMap((other) => differences(first, other).map(([key]) => key)))];
    const at = (/** @type {any} */ shape, /** @type {string} */ key) => key.split(".").reduce((node, part) => node?.[part], shape);
    const rows = keys.map((key) => [key, ...(this.shapes ?? []).map((shape) => brief(at(shape, key)))]);
    this.rest.replaceChildren(element("h2", "", "What differs between the cases"), rows.length
      ? table(["Field", ...this.ids.map((_, place) => this.label(place))], rows) : element("p", "", "Nothing: the cases are the same."));
  }

  /** Runs that go on are read again. */
  async refresh() {
    if (!this.jobs?.some(isOpen)) return;
    this.jobs = await Promise.all(this.ids.map((id) => read(`/v1/jobs/${id}`)));
    await this.draw();
  }

  close() {
    this.closing.abort();
    this.player?.close();
  }
}

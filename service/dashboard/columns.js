// @ts-check
/** The fields in which the cases of shown jobs differ, as columns of their table. */
import { read } from "./api.js";
import { brief, differences } from "./difference.js";
import { element } from "./page.js";

/** @typedef {import("./api.js").Job} Job */
const MOST = 8;
const NAMES = new Set(["name", "title", "description"]);

export class Columns {
  constructor() {
    this.shown = false;
    /** @type {Map<string, any>} */
    this.cases = new Map();
    /** @type {string[]} */
    this.keys = [];
  }

  /** Have the columns for these jobs; says whether they have changed. @param {Job[]} jobs */
  async update(jobs) {
    const wanted = this.shown ? jobs : [];
    await Promise.all(wanted.filter(({ id }) => !this.cases.has(id)).map(async ({ id, links }) =>
      this.cases.set(id, await read(links.case))));
    const [first, ...others] = wanted.map(({ id }) => this.cases.get(id));
    const keys = [...new Set(others.flatMap((one) => differences(first, one).map(([key]) => key)))]
      .filter((key) => !NAMES.has(key)).slice(0, MOST);
    const changed = keys.join() !== this.keys.join();
    this.keys = keys;
    return changed;
  }

  /** The value of each column for a job. @param {string} id */
  cells(id) {
    const shape = this.cases.get(id);
    return this.keys.map((key) => {
      const cell = element("td", "value", shape ? brief(key.split(".").reduce((node, part) => node?.[part], shape)) : "");
      cell.dataset.head = key;
      return cell;
    });
  }

  heads() {
    return this.keys.map((key) => {
      const head = element("th", "value", key);
      head.setAttribute("scope", "col");
      return head;
    });
  }
}

// @ts-check
/** The table of jobs: filters, search, pages by cursor, live. */
import { call, follow, read } from "./api.js";
import { Columns } from "./columns.js";
import { MOST } from "./compare.js";
import { actions, bar, byId, element, isOpen, standing } from "./page.js";

/** @typedef {import("./api.js").Job} Job */
const PAGE = 50, LARGEST_PAGE = 200;
const STREAMS = 3; // a browser keeps at most six connections to a host
const FILTERS = ["status", "label", "owner", "since", "until", "ensemble"];
const DAYS = ["since", "until"]; // filters whose value is a day, which begins at midnight here

export class JobsTable {
  /** @param {URLSearchParams} chosen the filters, as in the address of this page */
  constructor(chosen) {
    this.chosen = chosen;
    /** @type {Map<string, {job: Job, row: HTMLElement}>} */
    this.known = new Map();
    this.wanted = PAGE;
    /** @type {string | null} where the next page lies */
    this.next = this.address(PAGE);
    this.closing = new AbortController();
    /** @type {Set<string>} ids that are to be compared */
    this.compared = new Set();
    this.columns = new Columns();
    this.columns.shown = byId("differing").checked;
    byId("compare").hidden = true;
    /** @type {Set<string>} ids that are followed by events */
    this.followed = new Set();
    this.body = /** @type {HTMLElement} */ (document.querySelector("#jobs tbody"));
    this.body.replaceChildren();
    this.offer([]);
    byId("filters").elements.ensemble.value = chosen.get("ensemble") ?? "";
  }

  /** @param {number} limit @param {Record<string, string>} [more] */
  address(limit, more = {}) {
    const query = new URLSearchParams({ limit: String(limit) });
    for (const name of FILTERS) {
      const value = this.chosen.get(name);
      if (value) query.set(name, DAYS.includes(name) ? new Date(`${value}T00:00`).toISOString() : value);
    }
    for (const [name, value] of Object.entries(more)) query.set(name, value);
    return `/v1/jobs?${query}`;
  }

  /** Whether the search has a job in it. @param {Job} job */
  found(job) {
    const sought = (this.chosen.get("search") ?? "").toLowerCase();
    return [job.title, job.label, job.id, job.outcome].join("\n").toLowerCase().includes(sought);
  }

  /** Offer ensembles as filters, and the one that is chosen. @param {{id: string, title: string}[]} ensembles */
  offer(ensembles) {
    const field = /** @type {HTMLSelectElement} */ (document.querySelector("#filters [name=ensemble]"));
    const chosen = this.chosen.get("ensemble") ?? "", known = new Map([...field.options].map((one) => [one.value, one]));
    for (const { id, title } of known.has(chosen) ? ensembles : [{ id: chosen, title: "" }, ...ensembles]) {
      const option = known.get(id) ?? field.appendChild(new Option("", id));
      option.textContent = title || id;
    }
  }

  /** Read older pages until as many jobs are shown as are wanted, or there are no more. */
  async fill() {
    while (this.next && this.known.size < this.wanted && !this.closing.signal.aborted) {
      const size = this.chosen.get("search") ? LARGEST_PAGE : PAGE;
      const page = await read(this.next.replace(/limit=\d+/, `limit=${size}`));
      page.jobs.forEach((/** @type {Job} */ job) => this.put(job));
      this.next = page.next;
      this.tell();
    }
    this.tell();
    await this.arrange();
    const { ensembles } = await read("/v1/ensembles");
    if (!this.closing.signal.aborted) this.offer(ensembles);
  }

  /** Show what differs between the cases, or no more. @param {boolean} shown */
  async differ(shown) {
    this.columns.shown = shown;
    await this.arrange();
  }

  /** Have the columns that the shown jobs ask for. */
  async arrange() {
    const jobs = [...this.known.values()].map(({ job }) => job);
    if (!await this.columns.update(jobs) || this.closing.signal.aborted) return;
    document.querySelectorAll("#jobs th.value").forEach((head) => head.remove());
    document.querySelector("#jobs thead tr")?.append(...this.columns.heads());
    for (const one of this.known.values()) {
      one.row.querySelectorAll(".value").forEach((cell) => cell.remove());
      one.row.append(...this.columns.cells(one.job.id));
    }
  }

  /** Show PAGE jobs more. */
  async more() {
    this.wanted = this.known.size + PAGE;
    await this.fill();
  }

  /** Read what is new, what runs, and what has ended since. */
  async refresh() {
    const newest = await read(this.address(PAGE));
    newest.jobs.forEach((/** @type {Job} */ job) => this.put(job));
    const asked = this.chosen.get("status");
    const running = asked && asked !== "running" ? [] : (await read(this.address(LARGEST_PAGE, { status: "running" }))).jobs;
    const ids = new Set(running.map((/** @type {Job} */ job) => job.id));
    const ended = [...this.known.values()].filter(({ job }) => job.status === "running" && !ids.has(job.id));
    for (const job of running) if (this.known.has(job.id)) this.put(job);
    for (const { job } of ended) this.put(await read(job.links.self));
    this.tell();
    await this.arrange();
    this.listen();
  }

  /** Follow some running jobs by their events. */
  listen() {
    for (const { job } of this.known.values()) {
      if (this.followed.size >= STREAMS) return;
      if (job.status !== "running" || this.followed.has(job.id)) continue;
      this.followed.add(job.id);
      follow(job, (now) => this.put(now), this.closing.signal).catch(() => {}).finally(() => this.followed.delete(job.id));
    }
  }

  /** Show a job as it is now, if it is searched for, in its place: newest first. @param {Job} job */
  put(job) {
    if (this.closing.signal.aborted || !this.found(job)) return;
    const old = this.known.get(job.id);
    if (old && JSON.stringify(old.job) === JSON.stringify(job)) return;
    const asked = this.chosen.get("status");
    if (asked && job.status !== asked) {
      old?.row.remove();
      this.known.delete(job.id);
      return;
    }
    const row = this.row(job);
    this.known.set(job.id, { job, row });
    if (old) {
      const focus = old.row.contains(document.activeElement);
      old.row.replaceWith(row);
      if (focus) row.querySelector("a")?.focus();
      return;
    }
    this.body.insertBefore(row, this.follower(job.id));
  }

  /** The row of the next older job; null where this is the oldest. @param {string} id */
  follower(id) {
    const last = this.body.lastElementChild;
    if (!last || last.id > id) return null;
    return [...this.body.children].find((one) => one.id < id) ?? null;
  }

  /** @param {Job} job */
  row(job) {
    const link = /** @type {HTMLAnchorElement} */ (element("a", "", job.title || job.id));
    link.href = `#/jobs/${job.id}`;
    const what = element("td", "", link, element("small", "", [job.label, job.id].filter(Boolean).join(", ")));
    const chosen = /** @type {HTMLInputElement} */ (document.createElement("input"));
    chosen.type = "checkbox";
    chosen.checked = this.compared.has(job.id);
    chosen.setAttribute("aria-label", `compare ${job.title}, ${job.id}`);
    chosen.onchange = () => this.choose(job.id, chosen.checked);
    const state = element("td", "", element("span", `status ${job.status}`, job.status));
    const ended = job.outcome || job.message;
    const progress = element("td", "", ...(job.status === "running" ? [bar(job)] : []), element("small", "", standing(job)));
    if (ended && !isOpen(job)) progress.append(element("small", "", job.message || job.outcome));
    const row = element("tr", "", element("td", "choose", chosen), what, state, progress, element("td", "when", new Date(job.created).toLocaleString()),
      element("td", "", job.owner), element("td", "row", ...actions(job, (deleted) => deleted ? this.remove(job.id) : this.refresh())));
    row.id = job.id;
    row.append(...this.columns.cells(job.id));
    return row;
  }

  /** Compare a job, or no more. @param {string} id @param {boolean} wanted */
  choose(id, wanted) {
    if (wanted) this.compared.add(id); else this.compared.delete(id);
    const many = this.compared.size, button = byId("compare");
    button.hidden = many < 2;
    button.disabled = many > MOST;
    button.textContent = many > MOST ? `At most ${MOST} runs can be compared` : `Compare ${many} runs`;
    button.onclick = () => location.assign(`#/compare?jobs=${[...this.compared].sort()}`);
  }

  /** @param {string} id */
  remove(id) {
    this.choose(id, false);
    this.known.get(id)?.row.remove();
    this.known.delete(id);
    this.tell();
  }

  /** Tell how many there are. */
  tell() {
    if (this.closing.signal.aborted) return;
    const shown = this.known.size;
    byId("count").textContent = `${shown} ${shown === 1 ? "job" : "jobs"} shown${this.next ? ", there are older ones" : ""}`;
    byId("empty").hidden = shown > 0 || this.next !== null;
    byId("more").hidden = !this.next;
  }

  close() {
    this.closing.abort();
  }
}

// @ts-check
/** The page of a job: its state, the film and the curves of its run, its case, downloads. */
import { follow, read, Refusal, save, send } from "./api.js";
import { Player } from "./cable/player.js";
import { Curves, series } from "./curves.js";
import { brief, differences, written } from "./difference.js";
import { actions, bar, button, byId, element, isOpen, notice, standing } from "./page.js";
import { table } from "./table.js";

/** @typedef {import("./api.js").Job} Job */

export class JobPage {
  /** @param {string} id */
  constructor(id) {
    this.address = `/v1/jobs/${encodeURIComponent(id)}`;
    this.closing = new AbortController();
    this.head = element("div", "");
    this.film = element("div", "");
    this.curves = new Curves();
    this.rest = element("div", "");
    /** @type {Job | null} */
    this.job = null;
    byId("page").replaceChildren(this.head, this.film, this.curves.place, this.rest);
  }

  /** Show the job, its run and its case. */
  async fill() {
    const [job, shape] = await Promise.all([read(this.address), read(`${this.address}/case`)]);
    if (this.closing.signal.aborted) return;
    this.shape = shape;
    await this.show(job);
    this.openFilm();
    await Promise.all([this.draw(), this.compare()]);
    if (isOpen(job)) follow(job, (now) => this.show(now), this.closing.signal).catch(() => {});
  }

  openFilm() {
    try {
      this.player = new Player([{ job: this.address, shape: this.shape }], (t) => this.curves.mark(t));
      this.film.append(this.player.place);
    } catch (error) {
      this.film.append(element("p", "faint", /** @type {Error} */ (error).message));
    }
  }

  /** Draw what there is of the run by now. */
  async draw() {
    const film = this.player?.more().catch((error) => {
      if (!(error instanceof Refusal) || error.passes) throw error;
      this.film.replaceChildren(element("p", "faint", error.message));
    });
    const run = await series(this.address, this.shape);
    if (run && !this.closing.signal.aborted) this.curves.draw(run);
    await film;
  }

  /** Read the job again while it is open; what it has come to is drawn with it. */
  async refresh() {
    if (!this.job || !isOpen(this.job)) return;
    const running = this.job.status === "running";
    await this.show(await read(this.address));
    if (running) await this.draw();
  }

  /** Show the case, and what differs from the shipped one of its name. */
  async compare() {
    const name = this.shape.name in await read("/v1/cases") ? this.shape.name : "";
    const shipped = name && await send("/v1/validate", { case: name }).then((verdict) => verdict.case, () => null);
    const text = element("pre", "", written(this.shape));
    text.tabIndex = 0;
    text.setAttribute("aria-label", "case as it is run");
    const whole = element("details", "", element("summary", "", "The whole case, as it is run"), text);
    this.rest.replaceChildren(element("h2", "", "Case"), ...(shipped ? this.changes(name, shipped) : []), whole);
  }

  /** @param {string} name @param {any} shipped */
  changes(name, shipped) {
    const found = differences(this.shape, shipped).filter(([key]) => key !== "schema_version");
    if (!found.length) return [element("p", "", `This is the shipped case ${name}.`)];
    return [table(["Field", "Here", `In ${name}`], found.map(([key, here, there]) => [key, brief(here), brief(there)]))];
  }

  /** @param {Job} job */
  async show(job) {
    if (this.closing.signal.aborted || JSON.stringify(job) === JSON.stringify(this.job)) return;
    const ended = this.job && isOpen(this.job) && !isOpen(job);
    this.job = job;
    document.title = `hockle: ${job.title}`;
    const waits = job.status === "accepted" ? (await read(`${this.address}/queue`)).before : null;
    this.head.replaceChildren(
      element("h2", "", job.title || job.id),
      element("p", `status ${job.status}`, job.status, waits === null ? "" : waits === 0 ? `: the next of ${job.owner}` : `: ${waits} ${waits === 1 ? "job" : "jobs"} of ${job.owner} first`),
      ...(job.status === "running" ? [bar(job), element("p", "faint", standing(job))] : []),
      ...(job.outcome && job.status !== "running" ? [this.outcome(job)] : []),
      element("div", "actions", ...actions(job, (deleted) => deleted ? location.assign("#/") : this.refresh()), ...this.more(job)), this.facts(job));
    if (ended) await Promise.all([this.draw(), this.player?.again()]);
  }

  /** How it ended, and what to do. @param {Job} job */
  outcome(job) {
    const told = element("p", "outcome", element("strong", "", job.outcome));
    if (job.message) told.append(`: ${job.message}`);
    return told;
  }

  /** @param {Job} job */
  more(job) {
    const shared = job.dataset ? [button("Share link", () => this.share(job))] : [];
    return [button("Rerun with changes", () => location.assign(`#/new?from=${job.id}`)), button("Case file", () => save(`${this.address}/case`, `${job.id}.json`)), ...shared];
  }

  /** Make a link that opens the dataset for whoever has it, for a day. @param {Job} job */
  async share(job) {
    try {
      const { href, expires } = await send(`${this.address}/links`, { seconds: 86400 });
      const address = new URL(href, location.href).href;
      const link = /** @type {HTMLAnchorElement} */ (element("a", "", address));
      link.href = address;
      this.head.querySelector(".shared")?.remove();
      this.head.append(element("p", "shared", `Whoever has it reads the dataset of ${job.id}, without a key, until ` +
        `${new Date(expires).toLocaleString()}: `, link));
    } catch (error) {
      notice(/** @type {Error} */ (error).message);
    }
  }

  /** @param {Job} job */
  facts(job) {
    const told = { id: job.id, label: job.label, owner: job.owner, submitted: new Date(job.created).toLocaleString(),
      ...(job.status === "running" ? {} : { run: standing(job) }), ...job.attributes };
    const facts = element("dl", "");
    for (const [name, value] of Object.entries(told)) {
      if (value !== "") facts.append(element("dt", "", name), element("dd", "", String(value)));
    }
    return element("details", "", element("summary", "", "About this run"), facts);
  }

  close() {
    this.closing.abort();
    this.player?.close();
  }
}

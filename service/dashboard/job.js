// @ts-check
/** The page of a job: its state, outcome with remedy, what the run says, its case, downloads. */
import { follow, read, save } from "./api.js";
import { chart } from "./chart.js";
import { actions, bar, button, byId, element, isOpen, standing } from "./page.js";

/** @typedef {import("./api.js").Job} Job */

export class JobPage {
  /** @param {string} id */
  constructor(id) {
    this.address = `/v1/jobs/${encodeURIComponent(id)}`;
    this.closing = new AbortController();
    this.head = element("div", "");
    this.rest = element("div", "");
    /** @type {Job | null} */
    this.job = null;
    this.charts = element("div", "charts");
    byId("job").replaceChildren(this.head, this.charts, this.rest);
  }

  /** Show the job and its case. */
  async fill() {
    const [job, shape] = await Promise.all([read(this.address), read(`${this.address}/case`)]);
    const text = JSON.stringify(shape, null, 1);
    const pre = element("pre", "", text);
    pre.tabIndex = 0;
    pre.setAttribute("aria-label", "case as it is run");
    this.rest.replaceChildren(element("h2", "", "Case"), pre);
    this.show(job);
    if (isOpen(job)) follow(job, (now) => this.show(now), this.closing.signal).catch(() => {});
  }

  /** Draw twist, writhe and link of the dataset, and what lacks between them. */
  async draw() {
    const { coordinates, variables } = await read(`${this.address}/data?variables=Tw,Wr,Lk`);
    const [Tw, Wr, Lk] = ["Tw", "Wr", "Lk"].map((name) => /** @type {(number | null)[]} */ (variables[name].values));
    const defect = Tw.map((twist, k) => {
      const writhe = Wr[k], link = Lk[k];
      return twist === null || writhe === null || link === null ? null : twist + writhe - link;
    });
    const time = coordinates.time.values, unit = variables.Tw.units;
    this.charts.replaceChildren(chart(`Twist, writhe, link (${unit})`, time, { Tw, Wr, Lk }),
      chart(`Tw + Wr - Lk (${unit})`, time, { "Tw + Wr - Lk": defect }));
  }

  async refresh() {
    if (this.job && isOpen(this.job)) this.show(await read(this.address));
  }

  /** @param {Job} job */
  show(job) {
    if (this.closing.signal.aborted || JSON.stringify(job) === JSON.stringify(this.job)) return;
    if (job.dataset && !this.job?.dataset) this.draw().catch((error) => this.charts.replaceChildren(error.message));
    this.job = job;
    document.title = `hockle: ${job.title}`;
    const facts = element("dl", "");
    const told = { outcome: job.outcome, "what to do": job.message, id: job.id, label: job.label, owner: job.owner,
      submitted: new Date(job.created).toLocaleString(), standing: standing(job), ...job.attributes };
    for (const [name, value] of Object.entries(told)) {
      if (value !== "") facts.append(element("dt", "", name), element("dd", "", String(value)));
    }
    const caseFile = button("Case", () => save(`${this.address}/case`, `${job.id}.json`));
    const share = button("Copy link", () => navigator.clipboard.writeText(location.href));
    this.head.replaceChildren(
      element("h2", "", job.title || job.id), element("p", `status ${job.status}`, job.status),
      ...(job.status === "running" ? [bar(job)] : []),
      element("div", "actions", ...actions(job, () => this.refresh()), caseFile, share), facts);
  }

  close() {
    this.closing.abort();
  }
}

// @ts-check
/** The page of an ensemble: its members over their parameters and results, each leading to its run. */
import { call, read } from "./api.js";
import { choice, labelled } from "./cable/player.js";
import { progress } from "./ensembles.js";
import { ask, button, byId, element, notice } from "./page.js";
import { told } from "./scale.js";
import { headed, parallel, scatter } from "./scatter.js";
import { table } from "./table.js";

/** What may be asked of a run's end, with its unit. */
const UNITS = /** @type {Record<string, string>} */ ({ max_curvature: "rad/m", energy_bending: "J", energy_torsion: "J", energy_kinetic: "J",
  Tw: "turns", Wr: "turns", Lk: "turns", min_gap: "m", contacts: "" });
const SCALARS = Object.keys(UNITS);
const FIRST = 2;

/** A value as it is told in a table. @param {any} value */
const short = (value) => typeof value === "number" ? told(value) : JSON.stringify(value);

export class EnsemblePage {
  /** @param {string} id */
  constructor(id) {
    this.address = `/v1/ensembles/${id}`;
    this.closing = new AbortController();
    this.head = element("div", "");
    this.pictures = element("div", "");
    this.members = element("div", "");
    this.choices = element("div", "controls");
    byId("page").replaceChildren(this.head, this.choices, this.pictures, this.members);
  }

  async fill() {
    const [one, { members }] = await Promise.all([read(this.address), read(`${this.address}/scalars?variables=${SCALARS}`)]);
    if (this.closing.signal.aborted) return;
    this.show(one);
    /** @type {import("./scatter.js").Member[]} */
    this.found = members.map((/** @type {any} */ member) => ({
      href: `#/jobs/${member.job}`, status: member.status, values: { ...member.parameters, ...member.values },
      label: `${Object.entries(member.parameters).map(([name, value]) => `${name} = ${JSON.stringify(value)}`).join(", ")}: ${member.outcome || member.status}`,
    }));
    const parameters = Object.keys(members[0]?.parameters ?? {});
    const scalars = SCALARS.filter((name) => members.some((/** @type {any} */ member) => member.values[name] !== null));
    this.choose([...parameters, ...scalars], parameters, scalars);
    this.draw(parameters);
    this.list(parameters, scalars.slice(0, FIRST), members);
  }

  /** @param {any} one */
  show(one) {
    this.one = one;
    document.title = `hockle: ${one.title}`;
    const counts = Object.entries(one.counts).filter(([, many]) => many).map(([status, many]) => `${many} ${status}`).join(", ");
    const open = one.counts.accepted + one.counts.running > 0;
    this.head.replaceChildren(element("h2", "", one.title || one.id), element("p", `status ${one.status}`, one.status),
      element("p", "faint", `${one.members} members: ${counts}`), this.jobs(), ...(open ? [progress(one), button("Cancel", () => this.cancel())] : []));
  }

  jobs() {
    const link = /** @type {HTMLAnchorElement} */ (element("a", "", "Its jobs in the table"));
    link.href = `#/?ensemble=${this.one.id}`;
    return link;
  }

  /** @param {string[]} columns @param {string[]} parameters @param {string[]} scalars */
  choose(columns, parameters, scalars) {
    if (this.offered === columns.join()) return;
    this.offered = columns.join(); // results come as members end
    const across = this.across?.value ?? columns[0], up = this.up?.value ?? "";
    this.across = choice("across", columns, () => this.draw(parameters));
    this.up = choice("up", columns, () => this.draw(parameters));
    this.across.value = across;
    this.up.value = scalars.includes(up) ? up : scalars[0] ?? parameters[parameters.length - 1];
    this.choices.replaceChildren(labelled("Across", this.across), labelled("Up", this.up));
  }

  /** @param {string[]} parameters */
  draw(parameters) {
    const { found = [] } = this, [across, up] = [this.across?.value ?? "", this.up?.value ?? ""];
    const columns = [...parameters, ...[...new Set([across, up])].filter((name) => !parameters.includes(name))];
    const told = columns.map((name) => this.column(name));
    this.pictures.replaceChildren(scatter(this.column(across), this.column(up), found), parallel(told, found));
  }

  /** @param {string} name @returns {import("./scatter.js").Column} */
  column(name) {
    return { name, unit: UNITS[name] ?? "", log: this.one.design?.parameters?.[name]?.scale === "log" };
  }

  /** @param {string[]} parameters @param {string[]} scalars @param {any[]} members */
  list(parameters, scalars, members) {
    const rows = members.map((member) => {
      const link = /** @type {HTMLAnchorElement} */ (element("a", "", String(member.number)));
      link.href = `#/jobs/${member.job}`;
      const values = scalars.map((name) => member.values[name] === null ? "" : told(member.values[name]));
      return [link, ...parameters.map((name) => short(member.parameters[name])), element("span", `status ${member.status}`,
        member.status), member.outcome, ...values];
    });
    this.members.replaceChildren(element("h2", "", "Members"), table(["Member", ...parameters, "Status", "Outcome", ...scalars.map((name) => headed(this.column(name)))], rows));
  }

  async cancel() {
    if (!await ask(`Cancel all members of "${this.one.title}" that have not ended?`, "Cancel them", "Keep them running")) return;
    await call(`${this.address}/cancel`, { method: "POST" }).catch((error) => notice(error.message));
    await this.fill();
  }

  async refresh() {
    if (this.one && this.one.counts.accepted + this.one.counts.running > 0) await this.fill();
  }

  close() {
    this.closing.abort();
  }
}

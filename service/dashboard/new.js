// @ts-check
/** A new case: a form with a shipped case or that of a job to start from, looked at by the server as it is filled in. */
import { read, Refusal, send } from "./api.js";
import { Preview } from "./cable/preview.js";
import { Form } from "./form.js";
import { button, byId, clock, element, notice } from "./page.js";

const PAUSE = 300; // ms without a key
const FILLING = "Values are in SI units. A vector is [x, y, z]. A profile (a function of s) or a schedule (of t) is a number or a table: " +
  '{"s": [0, 0.5, 1], "value": [1, 2, 1], "interpolation": "linear"}, with t for s where it is a schedule.';

export class NewPage {
  /** @param {URLSearchParams} chosen `case`: a shipped one, or `from`: the id of a job to start from */
  constructor(chosen) {
    this.chosen = chosen;
    this.closing = new AbortController();
    this.timer = 0;
    this.asked = 0;
    this.unseen = false;
    this.start = document.createElement("select");
    this.start.name = "start";
    this.label = document.createElement("input");
    this.label.maxLength = 100;
    this.label.name = "label";
    this.verdict = element("div", "verdict");
    this.verdict.setAttribute("role", "status");
    this.submit = button("Submit", () => this.hand());
    this.side = element("div", "side");
    document.title = "hockle: new case";
  }

  async fill() {
    const [schema, shipped] = await Promise.all([read("/v1/cases/schema"), read("/v1/cases")]);
    if (this.closing.signal.aborted) return;
    this.form = new Form(schema, () => this.soon());
    const from = this.chosen.get("from"), name = this.chosen.get("case") ?? Object.keys(shipped)[0];
    if (from) this.start.append(new Option(`job ${from}`, ""));
    for (const [key, title] of Object.entries(shipped)) this.start.append(new Option(`${key}: ${title}`, key));
    this.start.value = from ? "" : name;
    this.start.onchange = () => location.assign(`#/new?case=${this.start.value}`);
    this.form.set(await read(from ? `/v1/jobs/${from}/case` : `/v1/cases/${name}`));
    this.open();
    await this.check();
  }

  open() {
    try {
      this.preview = new Preview();
      this.side.append(this.preview.place);
    } catch (error) {
      this.side.append(element("p", "faint", /** @type {Error} */ (error).message));
    }
    this.submit.setAttribute("id", "submit");
    this.side.append(this.verdict, element("label", "", "Label ", this.label), this.submit);
    byId("page").replaceChildren(element("h2", "", "New case"), element("label", "", "Start from ", this.start), element("p", "faint", FILLING),
      element("div", "columns", /** @type {Form} */ (this.form).place, this.side));
  }

  /** Look at it once the typing pauses. */
  soon() {
    clearTimeout(this.timer);
    this.submit.toggleAttribute("disabled", true);
    this.unseen = true;
    this.timer = setTimeout(() => this.check().catch(() => {}), PAUSE); // refresh() asks again, and its fault is told
  }

  /** Have the server look at the case, and show what it says. */
  async check() {
    const question = this.asked += 1;
    const { faults, verdict } = await this.ask();
    if (question !== this.asked || this.closing.signal.aborted) return; // typed on meanwhile
    this.unseen = false;
    const warnings = verdict?.warnings ?? [];
    this.form?.tell(faults, warnings);
    this.submit.toggleAttribute("disabled", !verdict);
    this.verdict.replaceChildren(...(verdict ? [element("p", "cost", cost(verdict.cost))] : faults.map((one) => this.refused(one))));
    if (verdict) this.preview?.show(verdict.case);
  }

  /** What is refused and why; the name leads to the field. @param {import("./form.js").Fault} fault */
  refused({ pointer, rule }) {
    const name = pointer.slice(1).replaceAll("/", "."), field = this.form?.field(pointer);
    return element("p", "fault", field ? button(name, () => field.control.focus()) : name, ` ${rule}`);
  }

  /** @returns {Promise<{faults: import("./form.js").Fault[], verdict: any}>} */
  async ask() {
    try {
      return { faults: [], verdict: await send("/v1/validate", this.form?.get()) };
    } catch (error) {
      if (!(error instanceof Refusal) || error.status === 401) throw error;
      return { faults: error.problem.errors ?? [{ pointer: "", rule: error.message }], verdict: null };
    }
  }

  /** Submit it, and go to its job. */
  async hand() {
    try {
      const job = await send("/v1/jobs", { case: this.form?.get(), label: this.label.value });
      location.assign(`#/jobs/${job.id}`);
    } catch (error) {
      notice(/** @type {Error} */ (error).message);
    }
  }

  /** Have the server look at what it has not seen. */
  async refresh() {
    if (this.unseen) await this.check();
  }

  close() {
    clearTimeout(this.timer);
    this.closing.abort();
    this.preview?.close();
  }
}

/** @param {{nodes: number, frames: number, steps: number, seconds: number, bytes: number}} estimate */
function cost({ nodes, frames, steps, seconds, bytes }) {
  return `It takes about ${seconds < 1 ? "a second" : clock(seconds)} of one core: ${nodes} nodes, ${steps} steps, ${frames} frames, ` +
    `${(bytes / 1e6).toPrecision(2)} MB before compression.`;
}

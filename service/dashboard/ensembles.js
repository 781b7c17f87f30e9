// @ts-check
/** The table of ensembles. */
import { read } from "./api.js";
import { byId, element } from "./page.js";
import { table } from "./table.js";

export class EnsemblesPage {
  constructor() {
    this.closing = new AbortController();
    document.title = "hockle: ensembles";
  }

  async fill() {
    /** @type {any[]} */
    const found = [];
    for (let next = "/v1/ensembles?limit=200"; next;) {
      const page = await read(next);
      found.push(...page.ensembles);
      next = page.next;
    }
    if (this.closing.signal.aborted) return;
    const rows = found.map((one) => [link(one), element("span", `status ${one.status}`, one.status), progress(one),
      String(one.members), new Date(one.created).toLocaleString(), one.owner]);
    byId("page").replaceChildren(element("h2", "", "Ensembles"), found.length
      ? table(["Ensemble", "Status", "Progress", "Members", "Submitted", "Owner"], rows)
      : element("p", "", "No ensembles yet: one request to /v1/ensembles runs a case with many values."));
  }

  async refresh() {
    await this.fill();
  }

  close() {
    this.closing.abort();
  }
}

/** @param {any} one */
function link(one) {
  const made = /** @type {HTMLAnchorElement} */ (element("a", "", one.title || one.id));
  made.href = `#/ensembles/${one.id}`;
  return made;
}

/** @param {any} one */
export function progress(one) {
  const made = document.createElement("progress");
  made.value = one.progress;
  made.setAttribute("aria-label", `progress of ${one.title}`);
  return made;
}

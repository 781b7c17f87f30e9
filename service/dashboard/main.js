// @ts-check
/** Which page is shown, as its address says: #/?status=running is the table, #/jobs/ID one job, and so on. */
import { Refusal, setKey } from "./api.js";
import { ComparePage } from "./compare.js";
import { EnsemblePage } from "./ensemble.js";
import { EnsemblesPage } from "./ensembles.js";
import { JobPage } from "./job.js";
import { JobsTable } from "./jobs.js";
import { NewPage } from "./new.js";
import { byId, notice } from "./page.js";

const EVERY = 2500; // ms
/** A page: filled once, looked at again every now and then, and left.
 * @typedef {{fill: () => Promise<void>, refresh: () => Promise<void>, close: () => void}} View */
/** The pages but for the table of jobs, by the beginning of their addresses.
 * @type {[RegExp, (id: string, chosen: URLSearchParams) => View][]} */
const PAGES = [
  [/^\/jobs\/([0-9a-z]+)$/, (id) => new JobPage(id)],
  [/^\/compare$/, (_, chosen) => new ComparePage(chosen)],
  [/^\/ensembles$/, () => new EnsemblesPage()],
  [/^\/ensembles\/([0-9a-z]+)$/, (id) => new EnsemblePage(id)],
  [/^\/new$/, (_, chosen) => new NewPage(chosen)],
];
/** @type {View | null} */
let view = null;
let timer = 0;

/** The fields that choose jobs. */
const filters = () => [...byId("filters").elements].filter((field) => field.name);

/** Leave the page that is shown, and show the one that the address names. */
function open() {
  view?.close();
  const [path, query] = location.hash.replace(/^#/, "").split("?");
  const [where, page] = PAGES.find(([one]) => one.test(path)) ?? [];
  byId("jobs").hidden = Boolean(page);
  byId("page").hidden = !page;
  byId("page").replaceChildren();
  document.title = "hockle: jobs";
  const chosen = new URLSearchParams(query ?? "");
  for (const field of filters()) field.value = chosen.get(field.name) ?? "";
  view = where && page ? page(where.exec(path)?.[1] ?? "", chosen) : new JobsTable(chosen);
  const shown = view;
  guarded(() => shown.fill(), open); // what was not filled is opened anew
}

/** Look again at what is shown. */
const look = () => guarded(async () => view?.refresh());

/** Do it, tell of a fault, and look again a little later, unless it was refused for good.
 * @param {() => Promise<void>} work @param {() => void} [after] what is done instead of a look where the work failed */
async function guarded(work, after = look) {
  clearTimeout(timer);
  const shown = view;
  /** @type {() => void} */
  let next = look;
  try {
    await work();
    if (shown === view) notice("");
    byId("login").hidden = true;
    await health();
  } catch (error) {
    if (shown !== view) return;
    if (error instanceof Refusal && error.status === 401) return askForKey(error.keyed);
    notice(error instanceof Refusal ? error.message : "the server does not answer; it is asked again");
    if (error instanceof Refusal && !error.passes) return;
    if (!(error instanceof Refusal)) tellHealth(false, "away");
    next = after;
  }
  clearTimeout(timer);
  if (shown === view) timer = setTimeout(next, EVERY);
}

/** @param {boolean} refused whether there was a key */
function askForKey(refused) {
  view?.close();
  byId("jobs").hidden = byId("page").hidden = true;
  byId("login").hidden = false;
  byId("login").elements.key.focus();
  notice(refused ? "This key was refused: it is not known here, or it has expired or been revoked. A key begins with hk_." : "");
  health().catch(() => tellHealth(false, "away"));
}

async function health() {
  const state = await (await fetch("/readyz")).json();
  const parts = ["database", "broker", "disk", "workers", "leader"].filter((part) => state[part] !== "ok");
  const told = [...parts.map((part) => `${part}: ${state[part]}`), ...state.standing_still].join(", ");
  tellHealth(state.status === "ok", state.status === "ok" ? "serving" : told);
}

/** @param {boolean} ok @param {string} told */
function tellHealth(ok, told) {
  byId("health").className = ok ? "ok" : "bad";
  if (byId("health").textContent !== told) byId("health").textContent = told;
}

byId("login").onsubmit = (/** @type {Event} */ event) => {
  event.preventDefault();
  setKey(byId("login").elements.key.value.trim());
  byId("login").reset();
  byId("login").hidden = true;
  open();
};

byId("filters").onsubmit = (/** @type {Event} */ event) => event.preventDefault();
let typing = 0;
byId("filters").oninput = (/** @type {Event} */ event) => {
  if (event.target === byId("differing")) return;
  clearTimeout(typing);
  typing = setTimeout(() => {
    const chosen = new URLSearchParams();
    for (const field of filters()) if (field.value) chosen.set(field.name, field.value);
    history.replaceState(null, "", `#/?${chosen}`);
    open();
  }, 250);
};

byId("differing").onchange = () => {
  const shown = view;
  if (shown instanceof JobsTable) guarded(() => shown.differ(byId("differing").checked));
};

byId("more").onclick = () => {
  const shown = view;
  if (shown instanceof JobsTable) guarded(() => shown.more());
};

byId("theme").onclick = () => {
  const root = document.documentElement;
  const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  localStorage.setItem("theme", root.dataset.theme = dark ? "light" : "dark");
};
document.documentElement.dataset.theme = localStorage.getItem("theme") ?? "";

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || byId("ask").open || byId("jobs").hidden) return;
  if (/** @type {Element} */ (event.target).matches("input, select")) return;
  if (event.key === "/") {
    event.preventDefault();
    byId("filters").elements.search.focus();
  }
  if (event.key !== "j" && event.key !== "k") return;
  const links = [...document.querySelectorAll("#jobs tbody tr:not([hidden]) a")];
  const at = links.indexOf(/** @type {Element} */ (document.activeElement)) + (event.key === "j" ? 1 : -1);
  /** @type {HTMLElement | undefined} */ (links[Math.max(at, 0)])?.focus();
});

fetch("/docs/").then((answer) => byId("docs").hidden = !answer.ok, () => {}); // the site may not have been built

addEventListener("hashchange", () => {
  notice("");
  open();
});
open();

// @ts-check
/** Parts of a page, and how numbers are told. */
import { call, Refusal, save } from "./api.js";

/** @typedef {import("./api.js").Job} Job */

/** The element of this page with an id. @param {string} id */
export const byId = (id) => /** @type {any} */ (document.getElementById(id));

/** A new element. @param {string} name @param {string} className @param {...(string | Node)} inside */
export function element(name, className, ...inside) {
  const made = document.createElement(name);
  made.className = className;
  made.append(...inside);
  return made;
}

/** A new button, which tells of a fault of what it does. @param {string} text @param {() => any} act */
export function button(text, act) {
  const made = element("button", "", text);
  made.setAttribute("type", "button");
  made.onclick = () => Promise.resolve(act()).catch((error) =>
    notice(error instanceof Refusal ? error.message : "the server does not answer"));
  return made;
}

/** Whether a job is still to end. @param {Job} job */
export const isOpen = (job) => job.status === "accepted" || job.status === "running";

/** @param {number} seconds */
export function clock(seconds) {
  if (seconds < 9.95) return `${Number(seconds.toFixed(1))} s`;
  const whole = Math.round(seconds);
  if (whole < 60) return `${whole} s`;
  return whole < 3600 ? `${Math.floor(whole / 60)} min ${whole % 60} s` : `${(whole / 3600).toFixed(1)} h`;
}

/** What a job is at, or how long it took. @param {Job} job */
export function standing(job) {
  if (job.status === "running") {
    const left = job.remaining === null ? "" : `, ${clock(job.remaining)} left`;
    return `${job.phase || "starting"}, t = ${job.t.toFixed(2)} s${left}`;
  }
  if (!job.started || !job.finished) return "";
  return `took ${clock((Date.parse(job.finished) - Date.parse(job.started)) / 1000)}`;
}

/** A bar of a job's progress. @param {Job} job */
export function bar(job) {
  const made = document.createElement("progress");
  made.value = job.progress;
  made.setAttribute("aria-label", `progress of ${job.title}`);
  return made;
}

/** What can be done with a job: cancel it; or save its dataset, and delete it.
 * @param {Job} job @param {(deleted: boolean) => void} then */
export function actions(job, then) {
  if (isOpen(job)) {
    const cancel = button(job.cancel_requested ? "Cancelling" : "Cancel", () => asked(job, then));
    cancel.toggleAttribute("disabled", job.cancel_requested);
    return [cancel];
  }
  const dataset = job.dataset;
  const kept = dataset ? [button(`Dataset, ${(dataset.bytes / 1e6).toFixed(1)} MB`, () => save(dataset.href, `${job.id}.nc`))] : [];
  return [...kept, button("Delete", () => asked(job, then))];
}

/** Cancel or delete a job, if that is meant. @param {Job} job @param {(deleted: boolean) => void} then */
async function asked(job, then) {
  const open = isOpen(job);
  const sure = open ? ask(`Cancel "${job.title}"? It stops, and cannot go on later.`, "Cancel the run", "Keep it running")
    : ask(`Delete "${job.title}" with its dataset? Nobody can bring it back.`, "Delete it", "Keep it");
  if (!await sure) return;
  try {
    await (open ? call(`${job.links.self}/cancel`, { method: "POST" }) : call(job.links.self, { method: "DELETE" }));
    then(!open);
  } catch (error) {
    notice(/** @type {Error} */ (error).message);
  }
}

/** Whether it shall be done. @param {string} question @param {string} yes @param {string} no @returns {Promise<boolean>} */
export function ask(question, yes, no) {
  byId("question").textContent = question;
  const dialog = byId("ask");
  const [keep, act] = dialog.querySelectorAll("button");
  [keep.textContent, act.textContent] = [no, yes];
  dialog.returnValue = "no";
  dialog.showModal();
  return new Promise((resolve) => dialog.onclose = () => resolve(dialog.returnValue === "yes"));
}

/** Tell of a fault; "" takes it away. @param {string} text */
export function notice(text) {
  byId("notice").hidden = !text;
  if (byId("notice").textContent !== text) byId("notice").textContent = text;
}

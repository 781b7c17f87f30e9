// @ts-check
/** Requests to the service. The key is kept in this tab only. */

/** @typedef {{id: string, owner: string, status: string, title: string, label: string, phase: string,
 *   progress: number, remaining: number | null, t: number, outcome: string, message: string,
 *   cancel_requested: boolean, created: string, started: string | null, finished: string | null,
 *   attributes: Record<string, number | string>, dataset: {href: string, bytes: number} | null,
 *   links: Record<string, string>}} Job */

/** A refusal of the service; `status` is that of HTTP, 401 where a key is missing or not valid; `problem` its document. */
export class Refusal extends Error {
  /** @param {number} status @param {any} problem @param {boolean} [keyed] whether a key was sent */
  constructor(status, problem, keyed = false) {
    super(problem.detail || problem.title || `the server answers ${status}`);
    this.status = status;
    this.problem = problem;
    this.keyed = keyed;
  }

  /** Whether the same request may be answered a little later. */
  get passes() {
    return this.status >= 500 || this.status === 429;
  }
}

/** @param {string} key */
export const setKey = (key) => sessionStorage.setItem("key", key);

/** The answer to a request. Throws Refusal. @param {string} address @param {RequestInit} [options] */
export async function call(address, options = {}) {
  const key = sessionStorage.getItem("key");
  const headers = { ...options.headers, ...(key ? { Authorization: `Bearer ${key}` } : {}) };
  const answer = await fetch(address, { ...options, headers });
  if (answer.ok) return answer;
  if (answer.status === 401) sessionStorage.removeItem("key");
  throw new Refusal(answer.status, await answer.json().catch(() => ({})), Boolean(key));
}

/** The JSON in the answer. Throws Refusal. @param {string} address */
export const read = async (address) => (await call(address)).json();

/** The JSON in the answer to JSON that is sent. Throws Refusal. @param {string} address @param {any} body */
export const send = async (address, body) => (await call(address, {
  method: "POST", body: JSON.stringify(body), headers: { "Content-Type": "application/json" } })).json();

/** Save what lies at an address as a file; a plain link would be followed without the key.
 * @param {string} address @param {string} name */
export const save = async (address, name) => keep(await (await call(address)).blob(), name);

/** Save this as a file. @param {Blob} content @param {string} name */
export function keep(content, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

/** Give each state of a job as its events tell it, until it has ended or `signal` aborts.
 * @param {Job} job @param {(job: Job) => void} tell @param {AbortSignal} signal */
export async function follow(job, tell, signal) {
  const answer = await call(job.links.events, { signal });
  if (answer.status === 204 || !answer.body) return;
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  for (let kept = ""; ;) {
    const { done, value } = await reader.read();
    if (done) break;
    const events = (kept + value).split("\n\n");
    kept = events.pop() ?? "";
    for (const event of events) {
      if (/^event: progress$/m.test(event)) tell(JSON.parse(/^data: (.*)$/m.exec(event)?.[1] ?? "null"));
    }
  }
  tell(await read(job.links.self));
}

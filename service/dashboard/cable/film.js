// @ts-check
/** The frames of a run, as /v1/jobs/{id}/film gives them, and the rod at any time between them. */
import { call, Refusal } from "../api.js";
import { range } from "../scale.js";

/** Floats of a node in a picture: r (3), the number that colours it, and its quaternion (4). */
export const NODE = 8;

export class Film {
  constructor() {
    /** @type {number[]} */
    this.time = [];
    /** @type {number[]} */
    this.s = [];
    /** How many points press on each other, by frame. @type {number[]} */
    this.contacts = [];
    /** @type {Map<string, {units: string, components: number, values: Float32Array}>} */
    this.blocks = new Map();
    /** Corners of the box that holds all frames. @type {[number[], number[]]} */
    this.box = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  }

  /** Forget all frames. */
  clear() {
    this.time = [];
    this.s = [];
    this.contacts = [];
    this.blocks.clear();
    this.box = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    return false;
  }

  get nodes() {
    return this.s.length;
  }

  /** What may colour the rod. */
  get colours() {
    return [...this.blocks.keys()].filter((name) => name !== "r" && name !== "orientation");
  }

  /** Read the frames that are new; says whether there are any. @param {string} job its address */
  async more(job) {
    const last = this.time.length ? `?since=${this.time[this.time.length - 1]}` : "";
    try {
      return this.append(await (await call(`${job}/film${last}`)).arrayBuffer());
    } catch (error) {
      if (error instanceof Refusal && [404, 409].includes(error.status)) return false;
      throw error;
    }
  }

  /** @param {ArrayBuffer} answer */
  append(answer) {
    const length = new DataView(answer).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(answer, 4, length)));
    if (this.s.length && this.s.join() !== header.s.join()) return this.clear(); // a finer run has begun
    if (!header.time.length) return false;
    this.s = header.s;
    this.time.push(...header.time);
    this.contacts.push(...header.contacts);
    let at = 4 + length;
    for (const { name, units, components } of header.blocks) {
      const values = new Float32Array(answer, at, header.time.length * this.nodes * components);
      at += values.byteLength;
      this.blocks.set(name, { units, components, values: joined(this.blocks.get(name)?.values, values) });
      if (name === "r") this.widen(values);
    }
    return true;
  }

  /** @param {Float32Array} r */
  widen(r) {
    const [low, high] = this.box;
    for (let k = 0; k < r.length; k += 1) {
      const axis = k % 3;
      if (r[k] < low[axis]) low[axis] = r[k];
      if (r[k] > high[axis]) high[axis] = r[k];
    }
  }

  /** The values that a colour stands for, from the least to the largest. @param {string} colour */
  range(colour) {
    const block = this.blocks.get(colour);
    return block ? range(block.values) ?? [0, 1] : [0, 1];
  }

  /** The frame that is shown at a time: the last one that is not later. @param {number} t */
  frame(t) {
    let low = 0, high = this.time.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time[middle] <= t) low = middle; else high = middle - 1;
    }
    return low;
  }

  /** The rod at a time, between its frames on straight lines: NODE floats for each node.
   * @param {number} t @param {string} colour "" for none @param {Float32Array} into */
  at(t, colour, into) {
    const first = this.frame(t), second = Math.min(first + 1, this.time.length - 1);
    const span = this.time[second] - this.time[first];
    const part = span > 0 ? Math.min(Math.max((t - this.time[first]) / span, 0), 1) : 0;
    const r = this.values("r"), q = this.values("orientation"), value = this.blocks.get(colour)?.values;
    const n = this.nodes;
    for (let k = 0; k < n; k += 1) {
      const a = first * n + k, b = second * n + k, to = NODE * k;
      for (let i = 0; i < 3; i += 1) into[to + i] = r[3 * a + i] + part * (r[3 * b + i] - r[3 * a + i]);
      into[to + 3] = value ? value[a] + part * (value[b] - value[a]) : 0;
      let along = 0, size = 0;
      for (let i = 0; i < 4; i += 1) along += q[4 * a + i] * q[4 * b + i];
      const sign = along < 0 ? -1 : 1; // q and -q are one rotation
      for (let i = 0; i < 4; i += 1) {
        const mixed = q[4 * a + i] + part * (sign * q[4 * b + i] - q[4 * a + i]);
        into[to + 4 + i] = mixed;
        size += mixed * mixed;
      }
      for (let i = 4; i < 8; i += 1) into[to + i] /= Math.sqrt(size);
    }
    return into;
  }

  /** @param {string} name */
  values(name) {
    return /** @type {{values: Float32Array}} */ (this.blocks.get(name)).values;
  }
}

/** @param {Float32Array | undefined} before @param {Float32Array} after */
function joined(before, after) {
  if (!before) return after;
  const both = new Float32Array(before.length + after.length);
  both.set(before);
  both.set(after, before.length);
  return both;
}

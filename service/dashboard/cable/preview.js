// @ts-check
/** A case before it is run: the rod at t = 0, its ends, its loads. */
import { element } from "../page.js";
import { NODE } from "./film.js";
import { Stage } from "./stage.js";
import { arrow, diameter } from "./surroundings.js";
import { across, add, cross, dot, size, times, unit } from "./vectors.js";

/** @typedef {import("./vectors.js").Vector} Vector */
const NODES = 120, BODY = [0.93, 0.62, 0.2], SEEN = 0.006, LOADS_ALONG = 9;
const FORCE = [0.68, 0.14, 0.11, 1], MOMENT = [0.44, 0.19, 0.66, 1];
const ENDS = /** @type {Record<string, number[]>} */ ({ clamp: [0.1, 0.1, 0.1, 1], pin: [0.04, 0.34, 0.77, 1],
  slider: [0.07, 0.4, 0.23, 1], free: [0.6, 0.6, 0.6, 1] });
const DRIVEN = [0.6, 0.29, 0, 1];

export class Preview {
  constructor() {
    this.stage = new Stage("preview of the rod at the start, with its ends and loads");
    this.caption = element("p", "faint");
    this.place = element("div", "preview", this.stage.canvas, this.stage.legend, this.caption);
  }

  /** Show a case as the server understood it. @param {any} shape */
  show(shape) {
    const r = centreline(shape.initial, shape.rod.length), nodes = placed(r, shape.initial.a1);
    /** @type {[Vector, Vector]} */
    const box = [[0, 1, 2].map((i) => Math.min(...r.map((at) => at[i]))), [0, 1, 2].map((i) => Math.max(...r.map((at) => at[i])))];
    this.stage.set([shape], box, add(r[NODES - 1], r[0], -1));
    const extent = Math.max(...add(box[1], box[0], -1)), thick = Math.max(diameter(shape) / 2, SEEN * extent);
    /** @type {number[]} */
    const lines = [], points = ends(shape, r);
    this.stage.surroundings?.shadow(shape, nodes, lines);
    this.caption.textContent = `start: ${end(shape, "start")}, end: ${end(shape, "end")}`;
    loads(shape, r, 0.16 * extent, lines);
    this.stage.content = () => ({ rods: [{ nodes, radius: thick, body: BODY, range: null }], lines, points });
    this.stage.redraw();
  }

  close() {
    this.stage.close();
  }
}

/** Positions along the rod. @param {any} initial @param {number} length @returns {Vector[]} */
function centreline(initial, length) {
  const parts = Array.from({ length: NODES }, (_, k) => k / (NODES - 1));
  if (initial.shape === "straight") {
    const along = unit(initial.direction ?? [0, 0, 1]);
    return parts.map((part) => add(initial.origin ?? [0, 0, 0], along, part * length));
  }
  const points = initial.points;
  const reached = [0];
  for (let k = 1; k < points.length; k += 1) reached.push(reached[k - 1] + size(add(points[k], points[k - 1], -1)));
  return parts.map((part) => {
    const s = part * reached[reached.length - 1];
    const k = Math.min(Math.max(reached.findIndex((one) => one >= s), 1), points.length - 1);
    return add(points[k - 1], add(points[k], points[k - 1], -1), (s - reached[k - 1]) / (reached[k] - reached[k - 1]));
  });
}

/** Nodes of a picture: the section's axes are carried along the rod without turning about it.
 * @param {Vector[]} r @param {Vector | undefined} first the first principal axis at the start */
function placed(r, first) {
  const nodes = new Float32Array(NODE * r.length);
  let a1 = first ?? [1, 0, 0];
  r.forEach((at, k) => {
    const tangent = unit(add(r[Math.min(k + 1, r.length - 1)], r[Math.max(k - 1, 0)], -1));
    const normal = add(a1, tangent, -dot(a1, tangent));
    a1 = size(normal) > 1e-6 ? unit(normal) : across(tangent)[0];
    nodes.set([...at, 0, ...quaternion(a1, cross(tangent, a1), tangent)], NODE * k);
  });
  return nodes;
}

/** The rotation with these columns as (w, x, y, z). @param {Vector} a @param {Vector} b @param {Vector} c */
function quaternion(a, b, c) {
  const squares = [a[0] + b[1] + c[2], a[0] - b[1] - c[2], b[1] - a[0] - c[2], c[2] - a[0] - b[1]];
  const largest = squares.indexOf(Math.max(...squares)), q = Math.sqrt(1 + squares[largest]) / 2, f = 1 / (4 * q);
  const [x, y, z] = [b[2] - c[1], c[0] - a[2], a[1] - b[0]], [xy, xz, yz] = [b[0] + a[1], c[0] + a[2], c[1] + b[2]];
  return [[q, x * f, y * f, z * f], [x * f, q, xy * f, xz * f], [y * f, xy * f, q, yz * f], [z * f, xz * f, yz * f, q]][largest];
}

/** What an end is. @param {any} shape @param {string} name */
function end(shape, name) {
  const given = shape.ends[name];
  if (typeof given === "string") return given;
  const besides = [...(given.mass > 0 ? [`a body of ${given.mass} kg`] : []), ...(given.switches?.length ? ["switches"] : [])];
  return [given.preset, ...driven(given), ...besides].filter(Boolean).join(" with ");
}

/** The components of an end that have conditions of their own. @param {any} given */
function driven(given) {
  return Object.keys(given).filter((key) => !["preset", "frame", "mass", "switches"].includes(key));
}

/** A point of the kind's colour at each end. @param {any} shape @param {Vector[]} r */
function ends(shape, r) {
  return ["start", "end"].flatMap((name, k) => {
    const given = shape.ends[name], kind = typeof given === "string" ? given : given?.preset;
    const own = typeof given === "object" && driven(given).length > 0;
    return [...r[k ? r.length - 1 : 0], ...(own ? DRIVEN : ENDS[kind] ?? DRIVEN)];
  });
}

/** Arrows of the given loads, at their largest. @param {any} shape @param {Vector[]} r @param {number} length
 * @param {number[]} into */
function loads(shape, r, length, into) {
  const at = (/** @type {number} */ s) => r[Math.round(Math.min(s / shape.rod.length, 1) * (r.length - 1))];
  for (const load of shape.loads?.point ?? []) draw(load, [at(load.s)], length, into);
  for (const load of shape.loads?.distributed ?? []) {
    const places = Array.from({ length: LOADS_ALONG }, (_, k) => at(k / (LOADS_ALONG - 1) * shape.rod.length));
    draw(load, places, 0.5 * length, into);
  }
}

/** @param {any} load @param {Vector[]} places @param {number} length @param {number[]} into */
function draw(load, places, length, into) {
  for (const [kind, colour] of /** @type {[string, number[]][]} */ ([["force", FORCE], ["moment", MOMENT]])) {
    const vector = (load[kind] ?? []).map(largest);
    if (load.frame === "material" || !(size(vector) > 0)) continue; // it turns with the rod
    for (const place of places) arrow(into, add(place, unit(vector), -length), times(unit(vector), length), colour);
  }
}

/** The largest value of a number or a table. @param {any} given @returns {number} */
function largest(given) {
  const values = typeof given === "number" ? [given] : [given?.value ?? 0].flat();
  return values.reduce((best, one) => Math.abs(one) > Math.abs(best) ? one : best, 0);
}

// @ts-check
/** What is around rods in their picture: the ground with their shadows, floors, obstacles, weight, current, the lab axes, contacts. */
import { NODE } from "./film.js";
import { depth, Obstacles } from "./obstacles.js";
import { ticks, told } from "../scale.js";
import { across, add, dot, size, times, unit } from "./vectors.js";

/** @typedef {import("./vectors.js").Vector} Vector */
/** @typedef {import("./picture.js").Strokes} Strokes */
/** @typedef {import("./obstacles.js").Box} Box */
/** @typedef {import("./obstacles.js").Obstacle} Obstacle */
/** A plane: the places whose part along the normal is height. @typedef {{normal: Vector, height: number}} Plane */

const GRID = [0.5, 0.55, 0.62, 0.35], SHADOW = [0.35, 0.4, 0.48, 0.6], FLOOR = [0.55, 0.42, 0.3, 0.8];
const WEIGHT = [0.68, 0.14, 0.11, 1], CURRENT = [0.04, 0.45, 0.7, 1], CONTACT = [0.9, 0.1, 0.15, 1];
const MARKS = 60, ROUNDING = 2 ** -22; // of places that are 4-byte floats
const AXES = [[0.8, 0.15, 0.15, 1], [0.1, 0.55, 0.2, 1], [0.15, 0.35, 0.9, 1]];

/** Up, against gravity; without gravity e3, or -e1 where the rod lies along e3, as in the paper's figures.
 * And to the right what is longest. @param {any[]} shapes cases @param {Box} box @param {Vector} along the rod at first
 * @returns {[Vector, Vector]} */
export function upright(shapes, box, along) {
  const [gravity] = [...shapes.flatMap(weight), [0, 0, 0]], lies = size(along) > 0 && Math.abs(unit(along)[2]) > 0.7;
  const up = size(gravity) > 0 ? unit(times(gravity, -1)) : lies ? [-1, 0, 0] : [0, 0, 1];
  const extent = add(box[1], box[0], -1);
  const level = [0, 1, 2].map((i) => add([0, 1, 2].map((j) => i === j ? 1 : 0), up, -up[i]));
  const longest = [0, 1, 2].reduce((best, i) => extent[i] * size(level[i]) > extent[best] * size(level[best]) * 1.001 ? i : best, 0);
  return [up, size(level[longest]) > 1e-3 ? unit(level[longest]) : across(up)[0]];
}

/** The greatest diameter, m. @param {any} shape a case */
export function diameter(shape) {
  const given = shape.rod?.diameter;
  return typeof given === "number" ? given : Math.max(0, ...[given?.value ?? 0].flat());
}

/** @param {Strokes} into @param {Vector} from @param {Vector} to @param {number[]} colour */
export function line(into, from, to, colour) {
  into.push(...from, ...colour, ...to, ...colour);
}

/** @param {Strokes} into @param {Vector} from @param {Vector} along @param {number[]} colour */
export function arrow(into, from, along, colour) {
  const to = add(from, along);
  line(into, from, to, colour);
  for (const side of across(unit(along)).flatMap((one) => [one, times(one, -1)])) {
    line(into, to, add(add(to, along, -0.22), side, 0.09 * size(along)), colour);
  }
}

/** @param {any} shape a case @returns {Vector[]} its gravity, if there is any */
const weight = ({ loads }) => size(loads?.gravity ?? []) > 0 ? [loads.gravity] : [];

/** @param {any} shape a case @returns {Vector[]} its current, if there is any */
const current = ({ fluid }) => size(fluid?.current ?? []) > 0 ? [fluid.current] : [];

/** @param {any} shape a case @returns {Plane[]} its floor, if there is one */
const floor = ({ loads }) => loads?.floor ? [{ normal: unit(loads.floor.normal ?? [0, 0, 1]), height: loads.floor.height ?? 0 }] : [];

/** @param {any} shape a case @returns {Obstacle[]} */
const obstacles = ({ loads }) => (loads?.obstacles ?? []).map((/** @type {Obstacle} */ { start, end, radius }) => ({ start, end, radius }));

/** What some cases have, each once. @template T @param {any[]} shapes @param {(shape: any) => T[]} of @returns {T[]} */
function distinct(shapes, of) {
  return [...new Map(shapes.flatMap(of).map((one) => [JSON.stringify(one), one])).values()];
}

export class Surroundings {
  /** @param {any[]} shapes the cases @param {Box} rod the box of all frames of all @param {Vector} up */
  constructor(shapes, rod, up) {
    this.up = up;
    this.obstacles = new Obstacles(distinct(shapes, obstacles), rod);
    this.weights = distinct(shapes, (shape) => weight(shape).map(unit));
    this.currents = distinct(shapes, (shape) => current(shape).map(unit));
    this.floors = distinct(shapes, floor);
    const [low, high] = this.obstacles.box;
    const extent = Math.max(...add(high, low, -1));
    this.centre = times(add(low, high), 0.5);
    this.extent = extent;
    const half = [0, 1, 2].reduce((sum, i) => sum + Math.abs(up[i]) * (high[i] - low[i]) / 2, 0);
    /** The floors, or a plane below all. @type {Plane[]} */
    this.grounds = this.floors.length ? this.floors : [{ normal: up, height: dot(this.centre, up) - half - 0.12 * extent }];
    /** @type {Strokes} */
    this.lines = [];
    /** The squares of the ground, m. */
    this.step = ticks(0, extent, 8)[1];
    for (const ground of this.grounds) this.grid(ground, low, high);
    this.arrows(low);
  }

  /** What is drawn around the rods, in words, each with the class of its colour. */
  get told() {
    const { triangles, far } = this.obstacles;
    const all = /** @type {[string, string, boolean][]} */ ([[`squares of ${told(this.step)} m`, "", true],
      ["e1", "e1", true], ["e2", "e2", true], ["e3", "e3", true], ["floor", "floor", this.floors.length > 0],
      ["obstacle", "obstacle", triangles.length > 0], [`obstacles too far away to be drawn: ${far}`, "", far > 0],
      ["weight", "weight", this.weights.length > 0], ["current", "current", this.currents.length > 0]]);
    return all.filter(([, , drawn]) => drawn);
  }

  /** @param {Vector} at @param {Plane} ground */
  onGround(at, { normal, height } = this.grounds[0]) {
    return add(at, normal, height - dot(at, normal));
  }

  /** @param {Plane} ground @param {Vector} low @param {Vector} high */
  grid(ground, low, high) {
    const [first, second] = across(ground.normal), middle = this.onGround(this.centre, ground);
    /** @param {Vector} axis */
    const reach = (axis) => Math.max(0.2 * this.extent,
      [0, 1, 2].reduce((sum, i) => sum + Math.abs(axis[i]) * (high[i] - low[i]) / 2, 0)) + this.step;
    for (const [along, aside] of [[first, second], [second, first]]) {
      const [long, wide] = [reach(along), reach(aside)], many = Math.ceil(wide / this.step);
      for (let k = -many; k <= many; k += 1) {
        const at = add(middle, aside, k * this.step);
        line(this.lines, add(at, along, -long), add(at, along, long), this.floors.length ? FLOOR : GRID);
      }
    }
  }

  /** The lab axes at the lowest corner, weight and current beside it. @param {Vector} low */
  arrows(low) {
    const length = 0.1 * this.extent, corner = this.onGround(low);
    AXES.forEach((colour, i) => line(this.lines, corner, add(corner, [0, 1, 2].map((j) => i === j ? length : 0)), colour));
    const from = add(corner, this.up, 2.5 * length);
    for (const way of this.weights) arrow(this.lines, from, times(way, length), WEIGHT);
    for (const way of this.currents) arrow(this.lines, from, times(way, length), CURRENT);
  }

  /** The shadow of a rod on its floor, or the first ground. @param {any} shape its case @param {Float32Array} nodes @param {Strokes} into */
  shadow(shape, nodes, into) {
    const [ground] = [...floor(shape), ...this.grounds];
    let before = null;
    for (let k = 0; k < nodes.length; k += NODE) {
      const at = add(this.onGround([nodes[k], nodes[k + 1], nodes[k + 2]], ground), ground.normal, 1e-3 * this.extent);
      if (before) line(into, before, at, SHADOW);
      before = at;
    }
  }
}

/** Where strands of a rod are near enough to press on each other. @param {Float32Array} nodes @param {number[]} s
 * @param {any} shape the case @returns {Strokes} */
export function touching(nodes, s, shape) {
  const thick = diameter(shape), { cutoff = 1.1 * thick, skip = 4 * thick } = shape.contact ?? {};
  const points = [];
  for (let i = 0; i < s.length; i += 1) {
    const x = nodes[NODE * i], y = nodes[NODE * i + 1], z = nodes[NODE * i + 2];
    let nearest = cutoff * cutoff, with_ = -1;
    for (let j = i + 1; j < s.length; j += 1) {
      if (s[j] - s[i] <= skip) continue;
      const dx = nodes[NODE * j] - x, dy = nodes[NODE * j + 1] - y, dz = nodes[NODE * j + 2] - z;
      const square = dx * dx + dy * dy + dz * dz;
      if (square < nearest) [nearest, with_] = [square, j];
    }
    if (with_ < 0) continue;
    const j = NODE * with_;
    points.push((x + nodes[j]) / 2, (y + nodes[j + 1]) / 2, (z + nodes[j + 2]) / 2, ...CONTACT);
  }
  return points;
}

/** Where a rod is pressed into a floor or an obstacle, at most MARKS places along it. @param {Float32Array} nodes
 * @param {number[]} s @param {any} shape the case @returns {Strokes} */
export function pressed(nodes, s, shape) {
  const planes = floor(shape), solids = obstacles(shape), apart = s[s.length - 1] / MARKS, points = [];
  let last = -Infinity;
  for (let k = 0; k < s.length; k += 1) {
    if (s[k] - last < apart) continue;
    const at = [nodes[NODE * k], nodes[NODE * k + 1], nodes[NODE * k + 2]], rounding = ROUNDING * size(at);
    const inFloor = planes.some(({ normal, height }) => height - dot(at, normal) > rounding);
    if (!inFloor && !solids.some((one) => depth(one, at) > rounding)) continue;
    points.push(...at, ...CONTACT);
    last = s[k];
  }
  return points;
}

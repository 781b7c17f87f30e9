// @ts-check
/** Obstacles as surfaces: rounded bars and balls, drawn around the rod and faded out where they go on. */
import { across, add, cross, dot, size, times, unit } from "./vectors.js";

/** @typedef {import("./vectors.js").Vector} Vector */
/** @typedef {[Vector, Vector]} Box lowest and highest corner */
/** @typedef {{start: Vector, end?: Vector | null, radius: number}} Obstacle all that is nearer than radius to the segment */

/** Floats of a triangle's corner: its place (3), the normal outward (3), how far it is faded in (1). */
export const CORNER = 7;
const ALONG = 12, AROUND = 48; // facets along each part of an outline, and around it
const FAR = 2, ROOM = 0.5, FADING = 0.2; // extents of the rod: drawn if nearer; drawn so far around; faded over the last

export class Obstacles {
  /** @param {Obstacle[]} obstacles @param {Box} rod the box of all its frames */
  constructor(obstacles, rod) {
    const extent = Math.max(...add(rod[1], rod[0], -1)), centre = times(add(rod[0], rod[1]), 0.5);
    const near = obstacles.filter((one) => outside(nearest(one, centre), rod) < FAR * extent);
    /** How many are too far from the rod to be drawn. */
    this.far = obstacles.length - near.length;
    const core = around([...rod, ...near.map((one) => nearest(one, centre))]);
    const corners = near.flatMap((one) => triangles(one, core, extent));
    this.triangles = new Float32Array(corners.flat());
    /** The rod and what is drawn. */
    this.box = around([...rod, ...corners.filter((corner) => corner[6] > 0)]);
  }
}

/** How deep a place is in an obstacle; below 0 outside. @param {Obstacle} obstacle @param {Vector} at */
export function depth(obstacle, at) {
  return obstacle.radius - size(add(at, onSegment(obstacle, at), -1));
}

/** The point of an obstacle's segment that is nearest to a place. @param {Obstacle} obstacle @param {Vector} at */
function onSegment({ start, end }, at) {
  const way = add(end ?? start, start, -1), square = dot(way, way);
  return add(start, way, square > 0 ? bounded(dot(add(at, start, -1), way) / square, 0, 1) : 0);
}

/** The point of an obstacle's surface that is nearest to a place. @param {Obstacle} obstacle @param {Vector} at */
function nearest(obstacle, at) {
  const foot = onSegment(obstacle, at), way = add(at, foot, -1);
  return size(way) > 0 ? add(foot, way, obstacle.radius / size(way)) : at;
}

/** The surface of an obstacle. A place on it has two coordinates: u, along the axis on its outline (a quarter of a circle
 * about the start, the length, a quarter about the end; 0 where the length begins), and the angle about the axis, 0 towards a given place. */
class Surface {
  /** @param {Obstacle} obstacle @param {Vector} towards */
  constructor({ start, end, radius }, towards) {
    const way = add(end ?? start, start, -1), from = add(towards, start, -1);
    this.start = start;
    this.radius = radius;
    this.length = size(way);
    this.axis = this.length > 0 ? unit(way) : across(size(from) > 0 ? unit(from) : [0, 0, 1])[0];
    const aside = add(from, this.axis, -dot(from, this.axis));
    this.first = size(aside) > 1e-9 * size(from) ? unit(aside) : across(this.axis)[0];
    this.second = cross(this.axis, this.first);
  }

  /** What lies in a box: u from and to, and the largest angle. @param {Box} box */
  within(box) {
    const span = (/** @type {Vector} */ along) => reach(box, this.start, along), [low, high] = span(this.axis).map((z) => this.u(z));
    const narrowest = this.radius * Math.min(Math.cos(this.bend(low)), Math.cos(this.bend(high)));
    const wide = Math.max(...span(this.second).map(Math.abs)), halfIsSeen = wide < narrowest && span(this.first)[0] > 0;
    return { low, high, half: halfIsSeen ? Math.asin(wide / narrowest) : Math.PI };
  }

  /** By the place along the axis. @param {number} z */
  u(z) {
    const along = bounded(z, 0, this.length);
    return along + this.radius * Math.asin(bounded((z - along) / this.radius, -1, 1));
  }

  /** The angle of the normal out of the plane across the axis. @param {number} u */
  bend(u) {
    return (u - bounded(u, 0, this.length)) / this.radius;
  }

  /** A place, and the normal there. @param {number} u @param {number} angle */
  at(u, angle) {
    const sine = Math.sin(this.bend(u)), cosine = Math.cos(this.bend(u));
    const normal = add(add(times(this.axis, sine), this.first, cosine * Math.cos(angle)), this.second, cosine * Math.sin(angle));
    return [add(add(this.start, this.axis, bounded(u, 0, this.length)), normal, this.radius), normal];
  }
}

/** Corners of the triangles of an obstacle's surface around a box. @param {Obstacle} obstacle @param {Box} core
 * @param {number} extent of the rod @returns {Vector[]} */
function triangles(obstacle, core, extent) {
  const room = [ROOM, ROOM, ROOM].map((one) => one * extent), surface = new Surface(obstacle, times(add(core[0], core[1]), 0.5));
  const { low, high, half } = surface.within([add(core[0], room, -1), add(core[1], room)]);
  const stops = [low, ...[...new Set([0, surface.length])].filter((u) => low < u && u < high), high];
  const outline = stops.slice(1).flatMap((stop, k) => steps(stops[k], stop, ALONG));
  const rings = outline.map((u) => steps(-half, half, AROUND).map((angle) => {
    const [place, normal] = surface.at(u, angle);
    return [...place, ...normal, bounded((ROOM - outside(place, core) / extent) / FADING, 0, 1)];
  }));
  return rings.slice(1).flatMap((ring, i) => ring.slice(1).flatMap((d, k) => {
    const [a, b, c] = [rings[i][k], rings[i][k + 1], ring[k]];
    return [a, b, c, d].some((one) => one[6] > 0) ? [a, b, d, a, d, c] : []; // seen from outside they go round to the left
  }));
}

/** @param {number} low @param {number} high @param {number} many */
const steps = (low, high, many) => Array.from({ length: many + 1 }, (_, k) => low + k / many * (high - low));

/** @param {number} x @param {number} low @param {number} high */
const bounded = (x, low, high) => Math.min(Math.max(x, low), high);

/** How far a place is out of a box, along the axis where it is the most. @param {Vector} at @param {Box} box */
const outside = (at, [low, high]) => Math.max(0, ...at.slice(0, 3).map((x, i) => Math.max(low[i] - x, x - high[i])));

/** The box around points. @param {Vector[]} points @returns {Box} */
function around(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const point of points) {
    for (let i = 0; i < 3; i += 1) [low[i], high[i]] = [Math.min(low[i], point[i]), Math.max(high[i], point[i])];
  }
  return [low, high];
}

/** From where to where a box reaches along a direction from a point. @param {Box} box @param {Vector} from @param {Vector} along */
function reach([low, high], from, along) {
  const middle = dot(add(times(add(low, high), 0.5), from, -1), along);
  const half = [0, 1, 2].reduce((sum, i) => sum + Math.abs(along[i]) * (high[i] - low[i]) / 2, 0);
  return [middle - half, middle + half];
}

// @ts-check
/** Vectors of three numbers. */

/** @typedef {number[]} Vector */

/** @param {Vector} a @param {Vector} b */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @param {Vector} a @param {Vector} b */
export const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** a + factor b. @param {Vector} a @param {Vector} b @param {number} [factor] */
export const add = (a, b, factor = 1) => a.map((x, i) => x + factor * b[i]);
/** @param {Vector} a @param {number} factor */
export const times = (a, factor) => a.map((x) => x * factor);
/** @param {Vector} a */
export const size = (a) => Math.hypot(...a);
/** @param {Vector} a */
export const unit = (a) => times(a, 1 / size(a));
/** Two unit vectors normal to a unit vector and to each other. @param {Vector} a @returns {[Vector, Vector]} */
export function across(a) {
  const least = [0, 1, 2].reduce((best, i) => Math.abs(a[i]) < Math.abs(a[best]) - 1e-9 ? i : best, 0);
  const first = unit(add([0, 1, 2].map((i) => i === least ? 1 : 0), a, -a[least]));
  return [first, cross(a, first)];
}

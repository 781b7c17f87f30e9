// @ts-check
/** Ranges, round steps and SI prefixes of numbers that are drawn. */

const PREFIXES = /** @type {[number, string][]} */ ([
  [1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"], [1e-12, "p"]]);
const PREFIXED = new Set(["J", "N", "s", "m", "N m"]);

/** The least and the largest of the numbers that are there; null where there are none.
 * @param {Iterable<number | null>} values @returns {[number, number] | null} */
export function range(values) {
  let least = Infinity, largest = -Infinity;
  for (const value of values) {
    if (value === null || !Number.isFinite(value)) continue;
    if (value < least) least = value;
    if (value > largest) largest = value;
  }
  return least <= largest ? [least, largest] : null;
}

/** A range that has a width. @param {[number, number] | null} given @returns {[number, number]} */
export function widened(given) {
  const [low, high] = given ?? [0, 1];
  const least = Math.max(Math.abs(low), Math.abs(high)) * 1e-6 || 0.5;
  return high - low > least ? [low, high] : [low - least, high + least];
}

/** Round values within a range, about `many` of them. @param {number} low @param {number} high @param {number} many */
export function ticks(low, high, many) {
  const rough = (high - low) / many, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((one) => one * power >= rough) ?? 10);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k += 1) found.push(k * step);
  return found;
}

/** The factor and the name of a unit in which numbers up to `largest` are short.
 * @param {number} largest @param {string} unit @returns {[number, string]} */
export function prefixed(largest, unit) {
  if (!PREFIXED.has(unit) || !(largest > 0)) return [1, unit];
  const [factor, prefix] = PREFIXES.find(([one]) => largest >= one * 0.9999) ?? PREFIXES[PREFIXES.length - 1];
  return [factor, prefix + unit];
}

/** A number for people: so many digits that count. @param {number} value @param {number} [digits] */
export function told(value, digits = 4) {
  const short = Number(value.toPrecision(digits));
  return Math.abs(short) >= 1e6 || (short && Math.abs(short) < 1e-4) ? short.toExponential().replace("e+", "e") : String(short);
}

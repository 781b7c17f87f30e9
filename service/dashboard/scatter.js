// @ts-check
/** Pictures of an ensemble: its members as lines over parallel axes, and as points over two of them. */
import { element } from "./page.js";
import { range, ticks, told, widened } from "./scale.js";
import { drawn } from "./svg.js";

/** A member: where its run is found, how it is named, its status, and a value for each column; null where it has none.
 * @typedef {{href: string, label: string, status: string, values: Record<string, any>}} Member */
/** Where values lie between 0 and 1, and what stands beside an axis. @typedef {{at: (value: any) => number | null,
 *  marks: [number, string][]}} Axis */

const WIDTH = 960, HEIGHT = 320, SIDE = 70, TOP = 40, BOTTOM = 28;

const DECADES = 2;

/** A number or a word of each member: its name, its unit, and whether it was sampled by its logarithm.
 * @typedef {{name: string, unit: string, log: boolean}} Column */

/** An axis for the values of a column: numbers, those above 0 over two decades and more by their logarithms, or words one
 * below the other. @param {any[]} values @param {boolean} log @returns {Axis} */
export function axis(values, log) {
  const there = values.filter((value) => value !== null && value !== undefined);
  if (there.every((value) => typeof value === "number")) {
    const [least, most] = range(there) ?? [0, 0];
    if (least > 0 && (log || most >= 10 ** DECADES * least)) return logarithmic(there);
    const [low, high] = widened(range(there)), share = (/** @type {number} */ x) => (x - low) / (high - low);
    return { at: (value) => typeof value === "number" ? share(value) : null,
      marks: ticks(low, high, 5).map((x) => [share(x), told(x)]) };
  }
  const words = [...new Set(there.map((value) => JSON.stringify(value)))];
  const place = (/** @type {string} */ word) => (words.indexOf(word) + 0.5) / words.length;
  return { at: (value) => value === undefined || value === null ? null : place(JSON.stringify(value)),
    marks: words.map((word) => [place(word), word.length > 14 ? `${word.slice(0, 13)}...` : word]) };
}

/** @param {number[]} values @returns {Axis} */
function logarithmic(values) {
  const [low, high] = widened(range(values.map(Math.log10))), share = (/** @type {number} */ x) => (Math.log10(x) - low) / (high - low);
  const every = Math.ceil((high - low) / 5), within = high - low < 2 ? [1, 2, 5] : [1];
  const marks = Array.from({ length: Math.ceil(high - low) + 2 }, (_, k) => Math.floor(low) + k).filter((power) => power % every === 0)
    .flatMap((power) => within.map((digit) => digit * 10 ** power)).filter((x) => share(x) >= 0 && share(x) <= 1);
  return { at: (value) => typeof value === "number" ? share(value) : null, marks: marks.map((x) => [share(x), told(x)]) };
}

/** A link to a member's run around what stands for it. @param {Member} member @param {Element} inside */
function link(member, inside) {
  const made = drawn("a", { href: member.href, class: `member ${member.status}`, "aria-label": member.label });
  made.append(drawn("title", {}, member.label), inside);
  return made;
}

/** @param {string} label */
function picture(label) {
  return drawn("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "chart", role: "group", "aria-label": label });
}

/** A column's name and unit. @param {Column} column */
export const headed = ({ name, unit }) => unit ? `${name} (${unit})` : name;

/** Parallel coordinates: an axis for each column, a line for each member. @param {Column[]} columns @param {Member[]} members */
export function parallel(columns, members) {
  const made = picture(`members over ${columns.map(({ name }) => name).join(", ")}`);
  const x = (/** @type {number} */ k) => SIDE + k * (WIDTH - 2 * SIDE) / Math.max(1, columns.length - 1);
  const y = (/** @type {number} */ share) => HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM);
  const axes = columns.map(({ name, log }) => axis(members.map((member) => member.values[name]), log));
  for (const member of members) {
    const at = columns.map(({ name }, k) => axes[k].at(member.values[name]));
    let d = "", pen = "M";
    at.forEach((share, k) => {
      if (share !== null) d += `${pen}${x(k).toFixed(1)} ${y(share).toFixed(1)}`;
      pen = share === null ? "M" : "L";
    });
    made.append(link(member, drawn("path", { d: d || "M0 0" })));
  }
  columns.forEach((column, k) => {
    const anchor = k === 0 ? "start" : k === columns.length - 1 ? "end" : "middle";
    made.append(drawn("line", { class: "axis", x1: x(k), x2: x(k), y1: y(0), y2: y(1) }),
      drawn("text", { x: x(k), y: 18 + 14 * (k % 2), "text-anchor": anchor, class: "name" }, headed(column)));
    for (const [share, text] of axes[k].marks) made.append(drawn("text", { x: x(k) + 6, y: y(share) + 4 }, text));
  });
  return element("figure", "wide", element("figcaption", "", "All members, a line each"), made);
}

/** A point for each member over two columns. @param {Column} across @param {Column} up @param {Member[]} members */
export function scatter(across, up, members) {
  const made = picture(`${up.name} over ${across.name}`);
  const [h, v] = [across, up].map(({ name, log }) => axis(members.map((member) => member.values[name]), log));
  const x = (/** @type {number} */ share) => SIDE + share * (WIDTH - 2 * SIDE);
  const y = (/** @type {number} */ share) => HEIGHT - BOTTOM - 16 - share * (HEIGHT - TOP - BOTTOM);
  for (const [share, text] of v.marks) {
    made.append(drawn("line", { class: "axis", x1: x(0), x2: x(1), y1: y(share), y2: y(share) }),
      drawn("text", { x: x(0) - 8, y: y(share) + 4, "text-anchor": "end" }, text));
  }
  for (const [share, text] of h.marks) {
    made.append(drawn("text", { x: x(share), y: HEIGHT - BOTTOM + 4, "text-anchor": "middle" }, text));
  }
  made.append(drawn("text", { x: WIDTH / 2, y: HEIGHT - 6, "text-anchor": "middle", class: "name" }, headed(across)));
  for (const member of members) {
    const [px, py] = [h.at(member.values[across.name]), v.at(member.values[up.name])];
    if (px !== null && py !== null) made.append(link(member, drawn("circle", { cx: x(px), cy: y(py), r: 6 })));
  }
  return element("figure", "wide", element("figcaption", "", `${headed(up)} over ${headed(across)}`), made);
}

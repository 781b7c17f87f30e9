// @ts-check
/** Curves over time, drawn as SVG. */
import { element } from "./page.js";

const SPACE = "http://www.w3.org/2000/svg";
const WIDTH = 480, HEIGHT = 220, LEFT = 64, RIGHT = 10, TOP = 10, BOTTOM = 26;

/** @param {string} name @param {Record<string, string | number>} attributes */
function drawn(name, attributes) {
  const made = document.createElementNS(SPACE, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  return made;
}

/** The least and the largest of the numbers that are there. @param {(number | null)[]} values */
function range(values) {
  let least = Infinity, largest = -Infinity;
  for (const value of values) {
    if (value === null) continue;
    least = Math.min(least, value);
    largest = Math.max(largest, value);
  }
  return least < largest ? [least, largest] : [least - 0.5, least + 0.5];
}

/** A figure of at most four curves over time in s; null where a curve has a gap.
 * @param {string} title @param {number[]} time @param {Record<string, (number | null)[]>} curves */
export function chart(title, time, curves) {
  const [from, to] = range(time), [low, high] = range(Object.values(curves).flat());
  const x = (/** @type {number} */ t) => LEFT + (t - from) / (to - from) * (WIDTH - LEFT - RIGHT);
  const y = (/** @type {number} */ v) => HEIGHT - BOTTOM - (v - low) / (high - low) * (HEIGHT - TOP - BOTTOM);
  const picture = drawn("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "chart", role: "img", "aria-label": title });
  for (const value of [low, (low + high) / 2, high]) {
    picture.append(drawn("line", { class: "axis", x1: LEFT, x2: WIDTH - RIGHT, y1: y(value), y2: y(value) }));
    const label = drawn("text", { x: LEFT - 6, y: y(value) + 4, "text-anchor": "end" });
    label.textContent = String(Number(value.toPrecision(3)));
    picture.append(label);
  }
  for (const [t, anchor] of /** @type {[number, string][]} */ ([[from, "start"], [to, "end"]])) {
    const label = drawn("text", { x: x(t), y: HEIGHT - 8, "text-anchor": anchor });
    label.textContent = `${Number(t.toPrecision(4))} s`;
    picture.append(label);
  }
  const legend = element("div", "legend");
  Object.entries(curves).forEach(([name, values], place) => {
    const points = values.flatMap((value, k) => value === null ? [] : [`${x(time[k]).toFixed(1)},${y(value).toFixed(1)}`]);
    picture.append(drawn("polyline", { class: `line${place}`, points: points.join(" ") }));
    legend.append(element("span", `line${place}`, name));
  });
  return element("figure", "", element("figcaption", "", title), picture, legend);
}

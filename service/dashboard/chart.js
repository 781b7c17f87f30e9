// @ts-check
/** Curves over time, drawn as SVG; the pointer or a film shows the values at one time. */
import { element } from "./page.js";
import { drawn } from "./svg.js";
import { prefixed, range, ticks, told, widened } from "./scale.js";

/** @typedef {(number | null)[]} Curve */
const WIDTH = 480, HEIGHT = 200, LEFT = 56, RIGHT = 12, TOP = 10, BOTTOM = 24;

export class Chart {
  /** A figure of at most six curves, each over a time in s. @param {string} title @param {string} unit
   * @param {{steps?: boolean}} [options] steps: values that hold until the next one */
  constructor(title, unit, options = {}) {
    this.title = title;
    this.unit = unit;
    this.steps = options.steps ?? false;
    this.picture = drawn("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "chart", role: "img" });
    this.heading = element("figcaption", "", title);
    this.legend = element("div", "legend");
    /** The time that is told, above the picture: to move it draws no curve anew. */
    this.marker = element("div", "marker");
    this.marker.style.inset = `${100 * TOP / HEIGHT}% 0 ${100 * BOTTOM / HEIGHT}% 0`;
    this.figure = element("figure", "", this.heading, element("div", "plot", this.picture, this.marker), this.legend);
    /** @type {[string, number[], Curve][]} */
    this.curves = [];
    /** Where the legend tells the values. @type {HTMLElement[]} */
    this.readings = [];
    this.from = this.low = 0;
    this.to = this.high = this.factor = 1;
    this.picture.addEventListener("pointermove", (event) => this.mark(this.timeAt(/** @type {PointerEvent} */ (event))));
    /** The time that is marked, in s. @type {number | null} */
    this.at = null;
  }

  /** Draw these curves instead; a null is a gap. @param {Record<string, [number[], Curve]>} curves */
  draw(curves) {
    this.curves = Object.entries(curves).map(([name, [time, values]]) => [name, time, values]);
    [this.from, this.to] = widened(range(this.curves.flatMap(([, time]) => [time[0], time[time.length - 1]])));
    const seen = widened(range(this.curves.flatMap(([, , values]) => [range(values) ?? []].flat())));
    const [factor, name] = prefixed(Math.max(Math.abs(seen[0]), Math.abs(seen[1])), this.unit);
    [this.factor, this.low, this.high] = [factor, seen[0] / factor, seen[1] / factor];
    this.heading.textContent = name ? `${this.title} (${name})` : this.title;
    this.picture.setAttribute("aria-label", `${this.title}: ${this.curves.map(([one]) => one).join(", ")} over time`);
    this.picture.replaceChildren(...this.axes(), ...this.curves.map(([, time, values], place) =>
      drawn("path", { class: `line${place}`, d: this.path(time, values) })));
    this.readings = this.curves.map(() => element("small", ""));
    this.legend.replaceChildren(...this.curves.map(([one], place) => element("span", `line${place}`, `${one} `, this.readings[place])));
    this.mark(this.at);
  }

  /** @param {number} t */
  x(t) {
    return LEFT + (t - this.from) / (this.to - this.from) * (WIDTH - LEFT - RIGHT);
  }

  /** @param {number} value */
  y(value) {
    return HEIGHT - BOTTOM - (value - this.low) / (this.high - this.low) * (HEIGHT - TOP - BOTTOM);
  }

  axes() {
    const whole = !this.unit; // a number of things
    const lines = ticks(this.low, this.high, 4).filter((value) => !whole || Number.isInteger(value)).flatMap((value) => [
      drawn("line", { class: "axis", x1: LEFT, x2: WIDTH - RIGHT, y1: this.y(value), y2: this.y(value) }),
      drawn("text", { x: LEFT - 6, y: this.y(value) + 4, "text-anchor": "end" }, told(value))]);
    const times = ticks(this.from, this.to, 5).map((t) =>
      drawn("text", { x: Math.min(this.x(t), WIDTH - 14), y: HEIGHT - 7, "text-anchor": "middle" }, told(t)));
    return [...lines, ...times, drawn("text", { x: LEFT - 6, y: HEIGHT - 7, "text-anchor": "end" }, "t (s)")];
  }

  /** @param {number[]} time @param {Curve} values */
  path(time, values) {
    let d = "", pen = "M";
    for (let k = 0; k < values.length; k += 1) {
      const value = values[k];
      if (value === null) {
        pen = "M";
        continue;
      }
      const x = this.x(time[k]).toFixed(1), y = this.y(value / this.factor).toFixed(1);
      d += this.steps && pen === "L" ? `H${x}V${y}` : `${pen}${x} ${y}`;
      pen = "L";
    }
    return d;
  }

  /** Show the values at a time; null: at the end. @param {number | null} t */
  mark(t) {
    this.at = t;
    this.marker.hidden = t === null;
    const x = this.x(Math.min(Math.max(t ?? this.to, this.from), this.to));
    this.marker.style.transform = `translateX(${100 * x / WIDTH}%)`;
    this.curves.forEach(([, time, values], place) => {
      const value = values[t === null ? values.length - 1 : nearest(time, t)] ?? null;
      this.readings[place].textContent = value === null ? "none" : told(value / this.factor);
    });
  }

  /** @param {PointerEvent} event */
  timeAt(event) {
    const { left, width } = this.picture.getBoundingClientRect();
    const share = ((event.clientX - left) / width * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT);
    return this.from + Math.min(Math.max(share, 0), 1) * (this.to - this.from);
  }
}

/** The place of the nearest of the times, which grow. @param {number[]} times @param {number} t */
export function nearest(times, t) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  return high > 0 && t - times[low] > times[high] - t ? high : Math.max(low, 0);
}

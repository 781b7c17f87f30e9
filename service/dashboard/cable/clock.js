// @ts-check
/** The time that a film shows: play, scrub, step, at a speed. */
import { button, element } from "../page.js";
import { told } from "../scale.js";

/** Seconds in which the whole is played; null: as fast as it was. */
const LENGTHS = /** @type {[string, number | null][]} */ ([["5 s", 5], ["10 s", 10], ["20 s", 20], ["60 s", 60], ["real time", null]]);

export class Clock {
  /** @param {(t: number) => void} tell each time that is shown */
  constructor(tell) {
    this.tell = tell;
    /** @type {number[]} */
    this.times = [0];
    this.t = 0;
    this.playing = false;
    this.last = 0;
    this.waiting = 0;
    this.toggle = button("Play", () => this.play(!this.playing));
    this.slider = /** @type {HTMLInputElement} */ (document.createElement("input"));
    this.slider.type = "range";
    this.slider.step = "any";
    this.slider.setAttribute("aria-label", "time");
    this.slider.oninput = () => {
      this.play(false);
      this.show(Number(this.slider.value));
    };
    this.length = document.createElement("select");
    this.length.append(...LENGTHS.map(([name]) => new Option(name)));
    this.length.selectedIndex = 1;
    this.reading = element("output", "");
    this.place = element("div", "clock", this.toggle, this.slider, this.reading,
      element("label", "", "Whole in ", this.length));
  }

  get from() {
    return this.times[0];
  }

  get to() {
    return this.times[this.times.length - 1];
  }

  /** Have these frames; who was at the newest one stays there. @param {number[]} times */
  set(times) {
    const newest = this.t >= this.to;
    this.times = times;
    this.slider.min = String(this.from);
    this.slider.max = String(this.to);
    this.show(newest ? this.to : this.t);
  }

  /** @param {number} t */
  show(t) {
    this.t = Math.min(Math.max(t, this.from), this.to);
    this.slider.value = String(this.t);
    this.reading.textContent = `t = ${told(this.t)} s`;
    this.slider.setAttribute("aria-valuetext", this.reading.textContent);
    this.tell(this.t);
  }

  /** Start, from the beginning where it is at its end, or stop. @param {boolean} on */
  play(on) {
    if (on && this.t >= this.to) this.show(this.from);
    this.playing = on;
    this.toggle.textContent = on ? "Pause" : "Play";
    this.last = performance.now();
    cancelAnimationFrame(this.waiting);
    if (on) this.waiting = requestAnimationFrame((now) => this.tick(now));
  }

  /** Simulated seconds in a second of playing. */
  get speed() {
    const seconds = LENGTHS[this.length.selectedIndex][1];
    return seconds ? (this.to - this.from) / seconds : 1;
  }

  /** @param {number} now */
  tick(now) {
    this.show(this.t + Math.max(0, now - this.last) / 1000 * this.speed);
    this.last = now;
    if (this.t >= this.to) this.play(false);
    else this.waiting = requestAnimationFrame((later) => this.tick(later));
  }

  /** Space plays, full stop and comma go a frame on and back. @param {KeyboardEvent} event */
  key(event) {
    if (event.key === " ") this.play(!this.playing);
    else if (event.key === "." || event.key === ",") this.step(event.key === "." ? 1 : -1);
    else return;
    event.preventDefault();
  }

  /** @param {number} by frames */
  step(by) {
    this.play(false);
    const at = this.times.findIndex((time) => time >= this.t - 1e-12);
    this.show(this.times[Math.min(Math.max(at + by, 0), this.times.length - 1)]);
  }

  close() {
    this.play(false);
  }
}

// @ts-check
/** The curves of a run over time: which figures there are, and their data, also while it runs. */
import { read, Refusal } from "./api.js";
import { Chart } from "./chart.js";

/** @typedef {import("./chart.js").Curve} Curve */
/** @typedef {{time: number[], curves: Record<string, Curve>}} Series */

const SCALARS = ["Tw", "Wr", "Lk", "energy_bending", "energy_torsion", "energy_kinetic", "energy_added_mass",
  "energy_potential", "energy_contact", "energy_balance", "dt", "newton_iterations", "max_curvature", "min_gap"];
const TENSIONS = ["tension at start", "tension at end"];
const MOST_FRAMES = 2000;
/** A curve that never is this part of the largest beside it is left out; so are turns that never are this many. */
const NOISE = 1e-4, LEAST_TURNS = 1e-3;

/** The figures of a run: title, unit ("" for numbers), curves by the name that the legend shows, and whether the values are steps.
 * @type {[string, string, Record<string, string>, boolean][]} */
export const FIGURES = [
  ["Twist, writhe, link", "turns", { Tw: "Tw", Wr: "Wr", Lk: "Lk" }, false],
  ["Defect Tw + Wr - Lk", "turns", { defect: "defect" }, false],
  ["Energies", "J", { bending: "energy_bending", torsion: "energy_torsion", kinetic: "energy_kinetic",
    "added mass": "energy_added_mass", "potential, from its start": "energy_potential", contact: "energy_contact" }, false],
  ["Energy balance, 0 if exact", "J", { balance: "energy_balance" }, false],
  ["Tension at the ends", "N", { "s = 0": TENSIONS[0], "s = L": TENSIONS[1] }, false],
  ["Largest curvature", "rad/m", { curvature: "max_curvature" }, false],
  ["Smallest gap", "m", { gap: "min_gap" }, false],
  ["Step dt", "s", { dt: "dt" }, true],
  ["Newton iterations of the step", "", { iterations: "newton_iterations" }, true],
];

/** Figures of several runs: title, unit, and the curve of each run.
 * @type {[string, string, string][]} */
const COMPARED = [["Twist", "turns", "Tw"], ["Writhe", "turns", "Wr"], ["Bending energy", "J", "energy_bending"],
  ["Torsional energy", "J", "energy_torsion"], ["Kinetic energy", "J", "energy_kinetic"],
  ["Tension at s = 0", "N", TENSIONS[0]], ["Largest curvature", "rad/m", "max_curvature"], ["Step dt", "s", "dt"]];

/** What a job has so far; null where it has no frames yet, or the service gives none of a running job.
 * @param {string} job its address @param {any} shape its case @returns {Promise<Series | null>} */
export async function series(job, shape) {
  const frames = Math.ceil(shape.t_end / shape.output.interval) + 1;
  const part = `${job}/data?time_stride=${Math.ceil(frames / MOST_FRAMES)}&variables=`;
  try {
    const { coordinates, variables } = await read(part + SCALARS.join());
    const time = coordinates.time.values;
    /** @type {Record<string, Curve>} */
    const curves = Object.fromEntries(SCALARS.map((name) => [name, variables[name].values]));
    const from = curves.energy_potential[0] ?? 0; // its zero is where the lab's is
    curves.energy_potential = curves.energy_potential.map((value) => value === null ? null : value - from);
    if (turns(curves) > LEAST_TURNS) curves.defect = time.map((/** @type {number} */ _, /** @type {number} */ k) => defect(curves.Tw[k], curves.Wr[k], curves.Lk[k]));
    if (shape.output.fields.includes("f")) {
      const ends = await Promise.all([`f&s_max=0`, `f&s_min=${shape.rod.length}`].map((end) => read(part + end)));
      ends.forEach((end, k) => curves[TENSIONS[k]] = time.map((/** @type {number} */ _, /** @type {number} */ frame) =>
        end.variables.f.values[frame]?.[0]?.[2] ?? null)); // a running job may have got more frames meanwhile
    }
    return time.length ? { time, curves } : null;
  } catch (error) {
    if (error instanceof Refusal && [404, 409].includes(error.status)) return null;
    throw error;
  }
}

/** The most turns of twist or writhe. @param {Record<string, Curve>} curves */
const turns = ({ Tw, Wr }) => Math.max(largest(Tw), largest(Wr));

/** @param {Curve} values */
const largest = (values) => values.reduce((/** @type {number} */ most, value) => Math.max(most, Math.abs(value ?? 0)), 0);

/** @param {number | null} Tw @param {number | null} Wr @param {number | null} Lk */
const defect = (Tw, Wr, Lk) => Tw === null || Wr === null || Lk === null ? null : Tw + Wr - Lk;

export class Curves {
  constructor() {
    /** @type {Map<string, Chart>} */
    this.charts = new Map();
    this.place = document.createElement("div");
    this.place.className = "charts";
  }

  /** Draw figures that have a curve for each of several runs, by their names. @param {Record<string, Series>} runs */
  compare(runs) {
    for (const [title, unit, name] of COMPARED) {
      const told = Object.entries(runs).filter(([, run]) => run.curves[name]?.some((value) => value));
      if (!told.length) continue;
      this.chart(title, unit, name === "dt").draw(Object.fromEntries(
        Object.entries(runs).map(([label, run]) => [label, [run.time, run.curves[name] ?? []]])));
    }
  }

  /** The figure of this title. @param {string} title @param {string} unit @param {boolean} steps */
  chart(title, unit, steps) {
    const known = this.charts.get(title);
    if (known) return known;
    const made = new Chart(title, unit, { steps });
    this.charts.set(title, made);
    this.place.append(made.figure);
    return made;
  }

  /** Draw the figures that say something of this run. @param {Series} run */
  draw(run) {
    for (const [title, unit, chosen, steps] of FIGURES) {
      if (unit === "turns" && turns(run.curves) <= LEAST_TURNS) continue;
      const curves = Object.entries(chosen).filter(([, name]) => run.curves[name]?.some((value) => value !== null));
      const sizes = curves.map(([, name]) => largest(run.curves[name]));
      const shown = curves.filter((_, k) => curves.length === 1 || sizes[k] > NOISE * Math.max(...sizes) || unit === "turns");
      if (!shown.length) continue;
      this.chart(title, unit, steps).draw(Object.fromEntries(shown.map(([name, from]) => [name, [run.time, run.curves[from]]])));
    }
  }

  /** Mark a time in all of them. @param {number} t */
  mark(t) {
    for (const chart of this.charts.values()) chart.mark(t);
  }
}

// @ts-check
/** A canvas on which rods are drawn, turned with pointer and keys. */
import { element } from "../page.js";
import { Camera } from "./camera.js";
import { Picture } from "./picture.js";
import { Surroundings, upright } from "./surroundings.js";

/** @typedef {import("./picture.js").Rod} Rod */
/** @typedef {import("./obstacles.js").Box} Box */
/** @typedef {import("./vectors.js").Vector} Vector */
export const VIEWS = /** @type {Record<string, Vector | null>} */ ({
  free: null, "along e1": [1, 0, 0], "along e2": [0, 1, 0], "along e3": [0, 0, 1] });
const TURN = 0.008, KEY_TURN = 0.1;

export class Stage {
  /** @param {string} label what the picture shows */
  constructor(label) {
    this.canvas = /** @type {HTMLCanvasElement} */ (element("canvas", "stage"));
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    /** What is drawn around the rods. */
    this.legend = element("div", "key");
    this.picture = new Picture(this.canvas);
    this.camera = new Camera([0, 0, 1], [1, 0, 0]);
    /** What is drawn at each frame. @type {() => {rods: Rod[], lines: number[], points: number[]}} */
    this.content = () => ({ rods: [], lines: [], points: [] });
    /** @type {Box} */
    this.box = [[0, 0, 0], [1, 1, 1]];
    /** Whether somebody chose what part is seen. */
    this.moved = false;
    this.waiting = 0;
    this.sizes = new ResizeObserver(() => this.fit());
    this.sizes.observe(this.canvas);
    this.listen();
  }

  /** Set the vertical, the ground and what is seen, for cases and the box of their rods.
   * @param {any[]} shapes @param {Box} box @param {Vector} along a rod at first */
  set(shapes, box, along) {
    const [up, right] = upright(shapes, box, along);
    this.camera = new Camera(up, right);
    this.surround(shapes, box);
    this.fit();
  }

  /** The same for rods that have gone on: the whole stays in the picture unless somebody has moved it.
   * @param {any[]} shapes @param {Box} box */
  follow(shapes, box) {
    this.surround(shapes, box);
    if (this.moved) this.redraw();
    else this.fit();
  }

  /** Set what is around the rods. @param {any[]} shapes @param {Box} box */
  surround(shapes, box) {
    this.surroundings = new Surroundings(shapes, box, this.camera.basis[2]);
    this.box = this.surroundings.obstacles.box;
    this.legend.replaceChildren(...this.surroundings.told.map(([text, colour]) => element("span", colour && `key-${colour}`, text)));
  }

  /** Look from where `view` says. @param {string} view one of VIEWS */
  look(view) {
    this.camera.look(VIEWS[view]);
    this.fit();
  }

  /** Show the whole. */
  fit() {
    this.moved = false;
    this.picture.resize();
    const low = this.box[0].slice(), high = this.box[1].slice(), around = this.surroundings;
    for (const ground of around?.grounds ?? []) {
      const { up, centre, extent } = /** @type {Surroundings} */ (around), below = around?.onGround(centre, ground) ?? centre;
      for (let i = 0; i < 3; i += 1) {
        const near = up[i] ** 2 > 0.5 && Math.abs(below[i] - centre[i]) < extent;
        if (near) [low[i], high[i]] = [Math.min(low[i], below[i]), Math.max(high[i], below[i])];
      }
    }
    this.camera.fit([low, high], this.picture.aspect);
    this.redraw();
  }

  /** Draw once the browser is ready to. */
  redraw() {
    if (!this.waiting) this.waiting = requestAnimationFrame(() => this.draw());
  }

  /** Draw now. */
  draw() {
    cancelAnimationFrame(this.waiting);
    this.waiting = 0;
    this.picture.resize();
    const { rods, lines, points } = this.content();
    const ground = getComputedStyle(this.canvas).backgroundColor.match(/[\d.]+/g) ?? [255, 255, 255];
    const around = this.surroundings?.lines ?? [], triangles = this.surroundings?.obstacles.triangles ?? new Float32Array(0);
    this.picture.draw(this.camera, rods, triangles, [...around, ...lines], points, ground.map((one) => Number(one) / 255));
  }

  listen() {
    const { canvas } = this;
    canvas.onpointermove = (event) => {
      if (!event.buttons) return;
      canvas.setPointerCapture(event.pointerId);
      if (event.shiftKey || event.buttons === 2) {
        this.moved = true;
        this.camera.pan(event.movementX / canvas.clientHeight, -event.movementY / canvas.clientHeight);
      } else this.turn(-event.movementX * TURN, event.movementY * TURN);
      this.redraw();
    };
    canvas.oncontextmenu = (event) => event.preventDefault();
    canvas.onwheel = (event) => {
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * 0.0012));
      this.redraw();
    };
    canvas.ondblclick = () => this.fit();
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const zoom = { "+": 0.9, "-": 1 / 0.9 }[event.key];
    if (turn) this.turn(turn[0] * KEY_TURN, turn[1] * KEY_TURN);
    else if (zoom) this.zoom(zoom);
    else return;
    event.preventDefault();
    this.redraw();
  }

  /** @param {number} yaw @param {number} pitch */
  turn(yaw, pitch) {
    this.camera.yaw += yaw;
    this.camera.pitch = Math.min(Math.max(this.camera.pitch + pitch, -Math.PI / 2), Math.PI / 2);
  }

  /** @param {number} by */
  zoom(by) {
    this.moved = true;
    this.camera.distance *= by;
  }

  close() {
    cancelAnimationFrame(this.waiting);
    this.sizes.disconnect();
    this.picture.close();
  }
}

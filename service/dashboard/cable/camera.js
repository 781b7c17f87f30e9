// @ts-check
/** Where a picture is seen from: an eye that goes around a target, the vertical upright. */
import { add, cross, dot, size, times, unit } from "./vectors.js";

/** @typedef {import("./vectors.js").Vector} Vector */
const HALF_HEIGHT = Math.tan(14 * Math.PI / 180);
const YAW = 0.5, PITCH = 0.3;
const ROOM = 1.08, CLOSER = 4; // around what is fitted; and how often the eye is put in front of its middle

export class Camera {
  /** @param {Vector} up the vertical @param {Vector} right what lies to the right in the first view, normal to it */
  constructor(up, right) {
    this.basis = [right, cross(up, right), up];
    this.yaw = YAW;
    this.pitch = PITCH;
    /** @type {Vector} */
    this.target = [0, 0, 0];
    this.distance = 1;
  }

  /** Right, up and towards the eye, in the lab. @returns {[Vector, Vector, Vector]} */
  axes() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const right = this.lab([cy, sy, 0]), towards = this.lab([sy * cp, -cy * cp, sp]);
    return [right, cross(towards, right), towards];
  }

  /** @param {Vector} inBasis */
  lab(inBasis) {
    return inBasis.reduce((sum, one, i) => add(sum, this.basis[i], one), [0, 0, 0]);
  }

  /** Look from where a lab direction points; null is the first view. @param {Vector | null} from */
  look(from) {
    if (!from) {
      [this.yaw, this.pitch] = [YAW, PITCH];
      return;
    }
    const [x, y, z] = this.basis.map((axis) => dot(unit(from), axis));
    this.pitch = Math.asin(Math.min(1, Math.max(-1, z)));
    if (Math.hypot(x, y) > 1e-6) this.yaw = Math.atan2(x, -y);
    else this.yaw = 0;
  }

  /** Bring a box into the picture. @param {[Vector, Vector]} box @param {number} aspect width by height */
  fit([low, high], aspect) {
    this.target = times(add(low, high), 0.5);
    const corners = Array.from({ length: 8 }, (_, corner) => [0, 1, 2].map((i) => corner >> i & 1 ? high[i] : low[i]));
    this.distance = this.distanceTo(corners, aspect);
    for (let k = 0; k < CLOSER; k += 1) {
      const [right, up, towards] = this.axes();
      for (const axis of [right, up]) { // what is near looks larger, so the middle of the box is not that of the picture
        const seen = corners.map((at) => dot(add(at, this.target, -1), axis) / (this.distance - dot(add(at, this.target, -1), towards)));
        this.target = add(this.target, axis, (Math.min(...seen) + Math.max(...seen)) / 2 * this.distance);
      }
      this.distance = this.distanceTo(corners, aspect);
    }
  }

  /** How far from the target the eye sees all these points. @param {Vector[]} corners @param {number} aspect */
  distanceTo(corners, aspect) {
    const [right, up, towards] = this.axes();
    return Math.max(1e-9, ...corners.map((corner) => {
      const at = add(corner, this.target, -1);
      const wide = Math.abs(dot(at, right)) / (HALF_HEIGHT * aspect), tall = Math.abs(dot(at, up)) / HALF_HEIGHT;
      return ROOM * Math.max(wide, tall) + dot(at, towards);
    }));
  }

  /** Move the target by parts of the picture's height. @param {number} x @param {number} y */
  pan(x, y) {
    const [right, up] = this.axes(), scale = 2 * HALF_HEIGHT * this.distance;
    this.target = add(add(this.target, right, -x * scale), up, y * scale);
  }

  /** From lab coordinates to clip space, by columns. @param {number} aspect */
  matrix(aspect) {
    const [right, up, towards] = this.axes();
    const [wide, tall] = [1 / (HALF_HEIGHT * aspect), 1 / HALF_HEIGHT];
    const near = this.distance * 0.02, far = this.distance * 20;
    const depth = (far + near) / (near - far), shift = 2 * far * near / (near - far);
    const t = this.target;
    const offset = [-wide * dot(right, t), -tall * dot(up, t), depth * (-dot(towards, t) - this.distance) + shift,
      dot(towards, t) + this.distance];
    const columns = [0, 1, 2].flatMap((i) => [wide * right[i], tall * up[i], depth * towards[i], -towards[i]]);
    return new Float32Array([...columns, ...offset]);
  }
}

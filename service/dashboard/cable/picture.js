// @ts-check
/** A picture by WebGL: rods as shaded tubes with a stripe along a1, obstacles, lines, and points. */
import { NODE } from "./film.js";
import { CORNER } from "./obstacles.js";

/** @typedef {import("./camera.js").Camera} Camera */
/** Positions (3) and colours (4) of the ends of lines, or of points. @typedef {number[]} Strokes */
/** @typedef {{nodes: Float32Array, radius: number, body: number[], range: number[] | null}} Rod
 * range: the values of the first and the last colour of the scale; null: the rod has the colour `body` */

const FACETS = 12, WIDE = 1024;
const OBSTACLE = [0.44, 0.5, 0.57, 0.75]; // what is behind one is seen through it
/** The colours of a scale from the least value to the largest; each differs from its neighbours in lightness too. */
export const SCALE = [[0.27, 0.0, 0.33], [0.23, 0.32, 0.55], [0.13, 0.57, 0.55], [0.37, 0.79, 0.38], [0.99, 0.91, 0.14]];

const TUBE = `#version 300 es
precision highp float;
uniform sampler2D rod;
uniform int nodes;
uniform float radius;
uniform mat4 camera;
out vec3 normal;
out float angle, value;
vec4 texel(int k) { return texelFetch(rod, ivec2(k % ${WIDE}, k / ${WIDE}), 0); }
vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.yzw, cross(q.yzw, v) + q.x * v); }
void main() {
  int at = gl_InstanceID - 1 + (gl_VertexID & 1), node = clamp(at, 0, nodes - 1); // the first and the last are caps
  vec4 place = texel(2 * node), q = texel(2 * node + 1);
  angle = float(gl_VertexID >> 1) * ${(2 * Math.PI / FACETS).toFixed(9)};
  vec3 outward = turned(q, vec3(cos(angle), sin(angle), 0.0));
  float end = gl_InstanceID == 0 ? -1.0 : gl_InstanceID == nodes ? 1.0 : 0.0;
  normal = end == 0.0 ? outward : turned(q, vec3(0.0, 0.0, end));
  value = place.w;
  gl_Position = camera * vec4(place.xyz + (at == node ? radius : 0.0) * outward, 1.0);
}`;
const TUBE_COLOUR = `#version 300 es
precision highp float;
uniform vec3 light, body, scale[${SCALE.length}];
uniform vec2 range;
uniform bool coloured;
in vec3 normal;
in float angle, value;
out vec4 colour;
void main() {
  vec3 paint = body;
  if (coloured) {
    float x = clamp((value - range.x) / (range.y - range.x), 0.0, 1.0) * ${(SCALE.length - 1).toFixed(1)};
    int k = int(min(x, ${(SCALE.length - 1.001).toFixed(3)}));
    paint = mix(scale[k], scale[k + 1], x - float(k));
  }
  if (angle < ${(Math.PI / 2).toFixed(6)}) paint = coloured ? paint * 0.45 : vec3(0.13, 0.22, 0.42);
  float lit = max(dot(normalize(normal), light), 0.0);
  colour = vec4(paint * (0.45 + 0.6 * lit) + 0.12 * pow(lit, 30.0), 1.0);
}`;
const SOLID = `#version 300 es
in vec3 position, outward;
in float shown;
uniform mat4 camera;
out vec3 normal;
out float opaque;
void main() { normal = outward; opaque = shown; gl_Position = camera * vec4(position, 1.0); }`;
const SOLID_COLOUR = `#version 300 es
precision highp float;
uniform vec3 light;
uniform vec4 body;
in vec3 normal;
in float opaque;
out vec4 colour;
void main() {
  if (opaque <= 0.0) discard;
  colour = vec4(body.rgb * (0.55 + 0.6 * max(dot(normalize(normal), light), 0.0)), body.a * opaque);
}`;
const STROKE = `#version 300 es
in vec3 position;
in vec4 paint;
uniform mat4 camera;
uniform float dot_size;
out vec4 given;
void main() { given = paint; gl_Position = camera * vec4(position, 1.0); gl_PointSize = dot_size; }`;
const STROKE_COLOUR = `#version 300 es
precision highp float;
in vec4 given;
out vec4 colour;
uniform bool round_;
void main() { if (round_ && length(gl_PointCoord - 0.5) > 0.5) discard; colour = given; }`;

export class Picture {
  /** @param {HTMLCanvasElement} canvas  Throws Error where there is no WebGL 2. */
  constructor(canvas) {
    this.canvas = canvas;
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!gl) throw new Error("this browser has no WebGL 2: the cable cannot be drawn");
    this.gl = gl;
    this.tube = program(gl, TUBE, TUBE_COLOUR);
    this.stroke = program(gl, STROKE, STROKE_COLOUR);
    this.texture = gl.createTexture();
    this.buffer = gl.createBuffer();
    this.strokes = layout(gl, this.stroke, this.buffer, [["position", 3], ["paint", 4]]);
    this.tubes = gl.createVertexArray();
    this.solid = program(gl, SOLID, SOLID_COLOUR);
    this.corners = gl.createBuffer();
    this.solids = layout(gl, this.solid, this.corners, [["position", 3], ["outward", 3], ["shown", 1]]);
    /** The triangles that the graphics card has. @type {Float32Array} */
    this.held = new Float32Array(0);
  }

  /** As many pixels as the canvas shows. */
  resize() {
    const ratio = Math.min(devicePixelRatio || 1, 2), { clientWidth, clientHeight } = this.canvas;
    const [wide, tall] = [Math.max(1, Math.round(clientWidth * ratio)), Math.max(1, Math.round(clientHeight * ratio))];
    if (this.canvas.width !== wide) this.canvas.width = wide;
    if (this.canvas.height !== tall) this.canvas.height = tall;
  }

  get aspect() {
    return this.canvas.width / this.canvas.height;
  }

  /** Draw it all. @param {Camera} camera @param {Rod[]} rods @param {Float32Array} triangles of obstacles
   * @param {Strokes} lines @param {Strokes} points @param {number[]} ground colour behind all */
  draw(camera, rods, triangles, lines, points, ground) {
    const { gl } = this;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(ground[0], ground[1], ground[2], 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    const matrix = camera.matrix(this.aspect);
    this.drawStrokes(matrix, lines, gl.LINES);
    gl.useProgram(this.tube);
    const [right, up, towards] = camera.axes();
    const light = towards.map((x, i) => 0.8 * x + 0.5 * up[i] - 0.33 * right[i]);
    gl.uniformMatrix4fv(this.at(this.tube, "camera"), false, matrix);
    gl.uniform3fv(this.at(this.tube, "light"), light);
    gl.uniform3fv(this.at(this.tube, "scale"), SCALE.flat());
    for (const rod of rods) this.drawRod(rod);
    this.drawSolids(matrix, light, triangles);
    gl.disable(gl.DEPTH_TEST); // contacts are seen through the tubes
    this.drawStrokes(matrix, points, gl.POINTS);
  }

  /** @param {Rod} rod */
  drawRod({ nodes, radius, body, range }) {
    const { gl } = this, many = nodes.length / NODE, tall = Math.ceil(2 * many / WIDE);
    const padded = new Float32Array(4 * WIDE * tall);
    padded.set(nodes);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, WIDE, tall, 0, gl.RGBA, gl.FLOAT, padded);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.uniform1i(this.at(this.tube, "nodes"), many);
    gl.uniform1f(this.at(this.tube, "radius"), radius);
    gl.uniform3fv(this.at(this.tube, "body"), body);
    gl.uniform1i(this.at(this.tube, "coloured"), range ? 1 : 0);
    if (range) gl.uniform2fv(this.at(this.tube, "range"), range);
    gl.bindVertexArray(this.tubes);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 2 * (FACETS + 1), many + 1);
  }

  /** @param {Float32Array} matrix @param {number[]} light @param {Float32Array} triangles */
  drawSolids(matrix, light, triangles) {
    const { gl } = this;
    if (!triangles.length) return;
    gl.useProgram(this.solid);
    gl.uniformMatrix4fv(this.at(this.solid, "camera"), false, matrix);
    gl.uniform3fv(this.at(this.solid, "light"), light);
    gl.uniform4fv(this.at(this.solid, "body"), OBSTACLE);
    gl.bindVertexArray(this.solids);
    if (this.held !== triangles) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.corners);
      gl.bufferData(gl.ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
      this.held = triangles;
    }
    gl.enable(gl.CULL_FACE); // only what faces the eye, so that each obstacle is one layer
    gl.drawArrays(gl.TRIANGLES, 0, triangles.length / CORNER);
    gl.disable(gl.CULL_FACE);
  }

  /** @param {Float32Array} matrix @param {Strokes} strokes @param {number} kind */
  drawStrokes(matrix, strokes, kind) {
    const { gl } = this;
    if (!strokes.length) return;
    gl.useProgram(this.stroke);
    gl.uniformMatrix4fv(this.at(this.stroke, "camera"), false, matrix);
    gl.uniform1f(this.at(this.stroke, "dot_size"), 6 * Math.min(devicePixelRatio || 1, 2));
    gl.uniform1i(this.at(this.stroke, "round_"), kind === gl.POINTS ? 1 : 0);
    gl.bindVertexArray(this.strokes);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(strokes), gl.STREAM_DRAW);
    gl.drawArrays(kind, 0, strokes.length / 7);
  }

  /** @param {WebGLProgram} one @param {string} name */
  at(one, name) {
    return this.gl.getUniformLocation(one, name);
  }

  /** Give back what the picture holds of the graphics card. */
  close() {
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}

/** How a program's inputs, each of so many floats, lie one after the other in a buffer.
 * @param {WebGL2RenderingContext} gl @param {WebGLProgram} one @param {WebGLBuffer | null} buffer @param {[string, number][]} inputs */
function layout(gl, one, buffer, inputs) {
  const made = gl.createVertexArray(), whole = inputs.reduce((sum, [, many]) => sum + many, 0);
  gl.bindVertexArray(made);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  let from = 0;
  for (const [name, many] of inputs) {
    const place = gl.getAttribLocation(one, name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, many, gl.FLOAT, false, 4 * whole, 4 * from);
    from += many;
  }
  return made;
}

/** @param {WebGL2RenderingContext} gl @param {string} vertices @param {string} fragments */
function program(gl, vertices, fragments) {
  const made = gl.createProgram();
  for (const [kind, text] of /** @type {[number, string][]} */ ([[gl.VERTEX_SHADER, vertices], [gl.FRAGMENT_SHADER, fragments]])) {
    const shader = /** @type {WebGLShader} */ (gl.createShader(kind));
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made) ?? "no program");
  return made;
}

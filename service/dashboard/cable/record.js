// @ts-check
/** A stage as a file: a PNG, or a video that the browser records while the film plays once. */
import { keep } from "../api.js";
import { notice } from "../page.js";

/** @typedef {import("./stage.js").Stage} Stage */
/** @typedef {import("./clock.js").Clock} Clock */
const KINDS = /** @type {[string, string][]} */ ([["video/mp4", "mp4"], ["video/webm", "webm"]]);

/** @param {Stage} stage @param {string} name */
export function picture(stage, name) {
  stage.draw(); // what was drawn before may be gone from the canvas
  stage.canvas.toBlob((made) => made && keep(made, name), "image/png");
}

/** Play the film from its beginning and save what is seen: as MP4 where the browser can, else as WebM.
 * @param {Stage} stage @param {Clock} clock @param {(kind: string) => string} name */
export function video(stage, clock, name) {
  const [kind, ending] = KINDS.find(([one]) => window.MediaRecorder?.isTypeSupported(one)) ?? [];
  if (!kind || !ending) return notice("this browser records no video: hockle film makes one of the dataset");
  const recorder = new MediaRecorder(stage.canvas.captureStream(30), { mimeType: kind, videoBitsPerSecond: 8e6 });
  /** @type {Blob[]} */
  const parts = [];
  recorder.ondataavailable = (event) => parts.push(event.data);
  recorder.onstop = () => keep(new Blob(parts, { type: kind }), name(ending));
  clock.show(clock.from);
  recorder.start();
  clock.play(true);
  const watch = setInterval(() => {
    if (clock.playing) return;
    clearInterval(watch);
    recorder.stop();
  }, 100);
}

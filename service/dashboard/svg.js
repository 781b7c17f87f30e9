// @ts-check
/** Parts of SVG pictures. */

const SPACE = "http://www.w3.org/2000/svg";

/** A new part. @param {string} name @param {Record<string, string | number>} attributes @param {string} [text] */
export function drawn(name, attributes, text) {
  const made = document.createElementNS(SPACE, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  if (text !== undefined) made.textContent = text;
  return made;
}

// @ts-check
/** What differs between two cases, and a case as text. */

/** The fields that differ, by dotted key: the value here and there; undefined where there is none.
 * @param {any} here @param {any} there @param {string} [key] @returns {[string, any, any][]} */
export function differences(here, there, key = "") {
  if (JSON.stringify(here) === JSON.stringify(there)) return [];
  const both = [here, there].every((one) => one !== null && typeof one === "object");
  if (!both || Array.isArray(here) !== Array.isArray(there) || (Array.isArray(here) && here.length !== there.length)) {
    return [[key, here, there]];
  }
  return [...new Set([...Object.keys(here), ...Object.keys(there)])].flatMap((name) =>
    differences(here[name], there[name], key ? `${key}.${name}` : name));
}

/** A value in one line; long lists shortened. @param {any} value */
export function brief(value) {
  if (value === undefined) return "not given";
  const text = JSON.stringify(value);
  return text.length <= 60 ? text : `${text.slice(0, 50)} ... (${text.length} characters)`;
}

/** A case as JSON in which lists of plain values stand on one line. @param {any} value @param {string} [indent]
 * @returns {string} */
export function written(value, indent = "") {
  if (value === null || typeof value !== "object") return JSON.stringify(value);
  const plain = Object.values(value).every((one) => one === null || typeof one !== "object");
  if (plain && (Array.isArray(value) || JSON.stringify(value).length < 90)) return JSON.stringify(value);
  const inner = `${indent} `;
  const parts = Array.isArray(value) ? value.map((one) => inner + written(one, inner))
    : Object.entries(value).map(([name, one]) => `${inner}${JSON.stringify(name)}: ${written(one, inner)}`);
  const [open, close] = Array.isArray(value) ? "[]" : "{}";
  return `${open}\n${parts.join(",\n")}\n${indent}${close}`;
}

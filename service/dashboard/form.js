// @ts-check
/** A form that follows from the JSON schema of a case. What is not a plain value is given as JSON. */
import { element } from "./page.js";

/** @typedef {{pointer: string, rule: string}} Fault */
/** A part of the form: its value, undefined where none is given.
 * @typedef {{place: HTMLElement, get: () => any, set: (value: any) => void}} Part */
/** @typedef {{control: HTMLInputElement | HTMLTextAreaElement | HTMLSelectElement, told: HTMLElement}} Field */

export class Form {
  /** @param {any} schema @param {() => void} change told of each change */
  constructor(schema, change) {
    this.schema = schema;
    /** By their pointers into the case. @type {Map<string, Field>} */
    this.fields = new Map();
    this.whole = this.group(schema, "", ["schema_version"]);
    this.place = element("form", "case", this.whole.place);
    this.place.addEventListener("input", change);
    this.place.addEventListener("submit", (event) => event.preventDefault());
  }

  /** The case that is filled in. */
  get() {
    return { schema_version: 1, ...this.whole.get() };
  }

  /** @param {any} value a case */
  set(value) {
    this.whole.set(value);
  }

  /** Show faults and warnings at their fields. @param {Fault[]} faults @param {Fault[]} warnings */
  tell(faults, warnings) {
    for (const [, { control, told }] of this.fields) {
      told.replaceChildren();
      control.removeAttribute("aria-invalid");
    }
    for (const [kind, list] of /** @type {[string, Fault[]][]} */ ([["fault", faults], ["warning", warnings]])) {
      for (const one of list) {
        const field = this.field(one.pointer);
        if (!field) continue;
        field.told.append(element("p", kind, one.rule));
        if (kind === "fault") field.control.setAttribute("aria-invalid", "true");
        field.control.closest("details")?.setAttribute("open", "");
      }
    }
  }

  /** The field that a pointer leads to, or into. @param {string} pointer */
  field(pointer) {
    for (let at = pointer; at; at = at.slice(0, at.lastIndexOf("/"))) {
      const found = this.fields.get(at);
      if (found) return found;
    }
    return undefined;
  }

  /** A schema with its references and its null taken away. @param {any} schema @returns {any} */
  resolved(schema) {
    const { anyOf, $ref, ...told } = schema;
    if ($ref) return this.resolved({ ...this.schema.$defs[$ref.split("/").pop()], ...told });
    const kinds = anyOf?.filter((/** @type {any} */ one) => one.type !== "null");
    return kinds?.length === 1 ? this.resolved({ ...kinds[0], ...told, nullable: kinds.length < anyOf.length }) : schema;
  }

  /** @param {any} given @param {string} pointer @param {boolean} required @returns {Part} */
  part(given, pointer, required) {
    const schema = this.resolved(given), name = pointer.slice(pointer.lastIndexOf("/") + 1);
    const kinds = schema.oneOf?.map((/** @type {any} */ one) => this.resolved(one)) ?? [];
    if (kinds.length && kinds.every((/** @type {any} */ one) => one.properties?.shape)) return this.shapes(kinds, pointer, name);
    if (!schema.properties) return this.leaf(schema, pointer, name, required);
    const group = this.group(schema, pointer, []);
    return schema.nullable ? this.optional(group, schema, name) : this.titled(group, schema, name, required);
  }

  /** The fields of an object. @param {any} schema @param {string} pointer @param {string[]} besides @returns {Part} */
  group(schema, pointer, besides) {
    const names = Object.keys(schema.properties).filter((name) => !besides.includes(name));
    const parts = names.map((name) => this.part(schema.properties[name], `${pointer}/${name}`, Boolean(schema.required?.includes(name))));
    return {
      place: element("div", "fields", ...parts.map((part) => part.place)),
      get: () => Object.fromEntries(names.flatMap((name, k) => {
        const value = parts[k].get();
        return value === undefined ? [] : [[name, value]];
      })),
      set: (value) => parts.forEach((part, k) => part.set(value?.[names[k]])),
    };
  }

  /** @param {Part} group @param {any} schema @param {string} name @param {boolean} required @returns {Part} */
  titled(group, schema, name, required) {
    const place = element("details", "", element("summary", "", name, hint(schema)), group.place);
    const set = (/** @type {any} */ value) => {
      place.toggleAttribute("open", required || Object.keys(value ?? {}).length > 0);
      group.set(value);
    };
    return { place, set, get: () => {
      const value = group.get();
      return required || Object.keys(value).length ? value : undefined;
    } };
  }

  /** A group that may be left out as a whole. @param {Part} group @param {any} schema @param {string} name @returns {Part} */
  optional(group, schema, name) {
    const given = /** @type {HTMLInputElement} */ (document.createElement("input"));
    given.type = "checkbox";
    given.onchange = () => group.place.hidden = !given.checked;
    const place = element("fieldset", "", element("legend", "", element("label", "", given, ` ${name}`), hint(schema)), group.place);
    return { place, get: () => given.checked ? group.get() : undefined, set: (value) => {
      given.checked = value !== undefined && value !== null;
      group.place.hidden = !given.checked;
      group.set(value ?? {});
    } };
  }

  /** One of several shapes. @param {any[]} kinds @param {string} pointer @param {string} name @returns {Part} */
  shapes(kinds, pointer, name) {
    const select = document.createElement("select"), inside = element("div", "");
    select.append(...kinds.map((one) => new Option(one.properties.shape.const)));
    /** @type {Part | null} */
    let part = null;
    const open = (/** @type {any} */ value) => {
      for (const key of this.fields.keys()) if (key.startsWith(`${pointer}/`)) this.fields.delete(key);
      part = this.group(kinds[select.selectedIndex], pointer, ["shape"]);
      part.set(value);
      inside.replaceChildren(part.place);
    };
    select.onchange = () => open({});
    open({});
    const place = element("details", "", element("summary", "", name), element("label", "", "shape ", select), inside);
    place.setAttribute("open", "");
    return { place, get: () => ({ shape: select.value, ...part?.get() }), set: (value) => {
      select.selectedIndex = Math.max(0, kinds.findIndex((one) => one.properties.shape.const === value?.shape));
      open(value);
    } };
  }

  /** A value. @param {any} schema @param {string} pointer @param {string} name @param {boolean} required @returns {Part} */
  leaf(schema, pointer, name, required) {
    const [control, read, write] = value(schema);
    const told = element("span", "told"), id = `case${pointer.replaceAll("/", "-")}`;
    control.id = id;
    told.id = `${id}-told`;
    told.setAttribute("role", "status");
    control.setAttribute("aria-describedby", told.id);
    control.toggleAttribute("required", required);
    this.fields.set(pointer, { control, told });
    const unit = schema.unit ? ` (${schema.unit})` : "";
    const label = element("label", "", `${name}${unit}`);
    label.setAttribute("for", id);
    return { place: element("div", "field", label, control, told, hint(schema)), get: read, set: write };
  }
}

/** A control for a value, and how it is read and written.
 * @param {any} schema @returns {[Field["control"], () => any, (value: any) => void]} */
function value(schema) {
  if (schema.enum || schema.type === "boolean") {
    const select = document.createElement("select"), options = schema.enum ?? [true, false];
    select.append(new Option(schema.default === undefined ? "" : `as usual: ${schema.default}`, ""));
    for (const one of options) select.append(new Option(String(one)));
    return [select, () => options[select.selectedIndex - 1], (given) => select.selectedIndex = options.indexOf(given) + 1];
  }
  const control = document.createElement(schema.maxLength > 1000 || schema.items ? "textarea" : "input");
  control.setAttribute("autocomplete", "off");
  if (schema.default !== undefined && schema.default !== null) control.placeholder = JSON.stringify(schema.default);
  const read = () => {
    const given = control.value.trim();
    if (!given) return undefined;
    return schema.type === "string" ? given : parsed(given);
  };
  return [control, read, (given) => control.value = typeof given === "string" ? given : JSON.stringify(given ?? undefined) ?? ""];
}

/** JSON, or the text where it is none: the server says what is wrong with it. @param {string} text */
function parsed(text) {
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/** @param {any} schema */
const hint = (schema) => element("small", "", (schema.description ?? "").replaceAll("`", ""));

// @ts-check
/** A table of values. */
import { element } from "./page.js";

/** @param {string[]} heads @param {(string | Node)[][]} rows */
export function table(heads, rows) {
  const head = element("tr", "", ...heads.map((text) => {
    const made = element("th", "", text);
    made.setAttribute("scope", "col");
    return made;
  }));
  const body = rows.map((row) => element("tr", "", ...row.map((one, k) => {
    const cell = element("td", "", one);
    cell.dataset.head = heads[k];
    return cell;
  })));
  const wide = element("div", "wide", element("table", "", element("thead", "", head), element("tbody", "", ...body)));
  wide.tabIndex = 0;
  wide.setAttribute("role", "region");
  wide.setAttribute("aria-label", heads.join(", "));
  return wide;
}

// Tables of text and numbers, and the one behind every plot.

import { h, newId } from "./dom.js";
import { tableButton } from "./saving.js";

const MOST_ROWS = 500;

// columns: heads; rows: arrays of text or nodes. The first column names the row; `textColumns` are left-aligned.
export function table({ columns, rows, caption = "", textColumns = 1 }) {
  const style = (index) => (index < textColumns ? "text" : null);
  const heads = columns.map((column, index) => h("th", { scope: "col", class: style(index) }, column));
  const line = (row) => h("tr", {}, row.map((cell, index) =>
    h(index ? "td" : "th", { scope: index ? null : "row", class: style(index) }, cell)));
  const more = rows.length > MOST_ROWS ? h("p", { class: "hint" }, `The first ${MOST_ROWS} of ${rows.length} rows.`) : null;
  return h("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": caption || `Table: ${columns.join(", ")}` },
    h("table", {}, caption ? h("caption", {}, caption) : null,
      h("thead", {}, h("tr", {}, heads)), h("tbody", {}, rows.slice(0, MOST_ROWS).map(line))), more, rows.length ? tableButton({ columns, rows, caption }) : null);
}

// A table that is made when it is opened; `make` gives what `table` takes.
export function tableBehind(make, summary = "The numbers behind it") {
  const details = h("details", { id: newId("numbers") }, h("summary", {}, summary));
  details.addEventListener("toggle", () => {
    if (details.open && details.children.length === 1) details.append(table(make()));
  });
  return details;
}

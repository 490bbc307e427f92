// What the service sees in a file before it is brought in: columns, first rows, units, what is asked, a small picture.

import { get, upload } from "./api.js";
import { h, message, replace } from "./dom.js";
import { submitButton, textInput } from "./forms.js";
import { followJob } from "./jobs.js";
import { axis, plot } from "./plots.js";
import { colour } from "./theme.js";

const ROWS = 4;
const WORDS = {
  frequency: "frequency", real: "real part", imaginary: "imaginary part", sample_time: "sample time", sample_rate: "sample rate",
  scheduling: "scheduling", ignored: "left out", counter: "count", repeat: "repeat",
};

export class FilePreview {
  // `form()` gives what is stated of the file; `forAll(units)` uses units for the other files; `onSeen(preview)`.
  constructor({ form, forAll, onSeen }) {
    Object.assign(this, { form, forAll, onSeen });
    this.units = new Map(); // of each column that one was stated of
    this.element = h("div", { class: "preview", "aria-live": "polite" });
    this.current = 0;
  }

  // Look into the file anew, as things are stated now.
  async look() {
    const turn = (this.current += 1);
    const progress = h("div", {});
    replace(this.element, progress);
    try {
      const { href } = await followJob(await upload("/previews", this.form()), progress);
      const seen = await get(href);
      if (turn !== this.current) return;
      if (seen.remembered) for (const one of seen.statedUnits) this.units.set(one.slice(0, one.lastIndexOf("=")), one.slice(one.lastIndexOf("=") + 1));
      this.#draw(seen);
      this.onSeen(seen);
    } catch (problem) {
      if (!problem.title) throw problem;
      if (turn === this.current) replace(this.element, message("warning", problem.errors?.[0]?.detail ?? problem.detail ?? problem.title));
    }
  }

  // Statements such as Frequency=Hz.
  statedUnits() {
    return [...this.units].filter(([, unit]) => unit).map(([name, unit]) => `${name}=${unit}`);
  }

  // Take over units stated of another file, where this one has the same columns.
  take(units, names) {
    if (!units.every(([name]) => names.includes(name))) return false;
    this.units = new Map(units);
    return true;
  }

  #draw(seen) {
    this.names = seen.columns.map((column) => column.name);
    const question = seen.problem ? message("warning", seen.problem.detail) : null;
    const notes = seen.warnings.map((warning) => h("p", { class: "hint" }, warning));
    const tables = seen.tables.length > 1 ? h("p", { class: "hint" }, `Tables in the file: ${seen.tables.filter(Boolean).join(", ")}. Shown: ${seen.variableGroup || "the first level"}.`) : null;
    const again = submitButton("Look again", () => this.look(), { class: "quiet" });
    const all = submitButton("Use these units for all files", () => this.forAll([...this.units]), { class: "quiet" });
    replace(this.element, h("h4", {}, "Preview"), question, tables, this.#columns(seen), notes,
      seen.remembered ? h("p", { class: "hint" }, "What was said of the plant's last file is used again.") : null, h("div", { class: "actions" }, again, all));
    if (seen.picture) this.#picture(seen.picture);
  }

  #columns(seen) {
    const row = (column) => h("tr", {},
      h("th", { scope: "row", class: "text" }, column.name),
      h("td", { class: "text" }, column.takenFor ? `${column.sign < 0 ? "minus " : ""}${WORDS[column.takenFor] ?? column.takenFor}` : "not used"),
      h("td", {}, this.#unit(column)),
      Array.from({ length: ROWS }, (_, i) => h("td", {}, column.firstValues[i] ?? "")));
    return h("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Columns of the file" },
      h("table", {}, h("thead", {}, h("tr", {}, ["column", "taken for", "unit", ...Array.from({ length: ROWS }, (_, i) => `value ${i + 1}`)].map((head) => h("th", { scope: "col" }, head)))),
        h("tbody", {}, seen.columns.map(row))));
  }

  #unit(column) {
    const input = textInput(this.units.get(column.name) ?? column.unit, { "aria-label": `unit of ${column.name}`, size: 8 });
    input.addEventListener("change", () => { this.units.set(column.name, input.value.trim()); this.look(); });
    return input;
  }

  #picture({ abscissa, values, curves }) {
    const time = abscissa === "timeSeconds";
    const series = ["--series-1", "--series-2"];
    plot(this.element, {
      caption: time ? "Input and output, thinned." : "The response, thinned.", height: 200,
      draw: () => ({
        data: curves.map(({ name, values: y }, i) => ({ x: values, y, name, yaxis: i ? "y2" : "y", mode: "lines", line: { width: 1.2, color: colour(series[i]) } })),
        layout: { xaxis: axis(time ? "time (s)" : "frequency (rad/s)", { log: !time }), yaxis: axis(curves[0].name), yaxis2: { ...axis(curves[1].name), overlaying: "y", side: "right", showgrid: false } },
      }),
      table: () => ({ columns: [time ? "time (s)" : "frequency (rad/s)", ...curves.map(({ name }) => name)], rows: values.map((x, i) => [String(x), ...curves.map(({ values: y }) => String(y[i]))]) }),
    });
  }
}

// One file on its way in: what is stated beside it, what its columns are, its problem at the field.

import { post, upload } from "./api.js";
import { append, h } from "./dom.js";
import { columnsOf, formatOf, LABELS, pointInName } from "./file_columns.js";
import { FilePreview } from "./file_preview.js";
import { field, fields, integerInput, numberInput, numberOf, select, submitButton, textInput } from "./forms.js";
import { followJob } from "./jobs.js";
import { bytes, exact, labelled } from "./numbers.js";
import { showProblem } from "./problems.js";

export class FileCard {
  // `onMade(href)` after the file has become an experiment, `onGone()` when the card is not needed any more;
  // `forAll(card, units)` uses the units stated of this file for the others.
  constructor(file, plant, designs, { onMade, onGone, forAll }) {
    Object.assign(this, { file, plant, onMade, onGone });
    this.format = formatOf(file.name);
    const point = pointInName(file.name, plant.schedulingVariables);
    this.point = plant.schedulingVariables.map((_, index) => numberInput(point?.[index]));
    this.name = textInput(file.name.replace(/\.\w+$/, ""));
    this.sampleTime = numberInput(null, { min: 0 });
    this.period = integerInput(null, { min: 2 });
    this.group = textInput();
    this.design = select([["", "none"], ...designs.map((one) => [one.id, one.request.name || one.id.slice(0, 8)])], "");
    this.inputLevel = numberInput();
    this.outputLevel = numberInput();
    this.hold = select([["", "not known"], ["zeroOrder", "held (zero-order hold)"], ["firstOrder", "straight lines (first-order hold)"], ["bandLimited", "band limited"]], "");
    this.feedback = select([["", "none"], ["true", "a controller acted"]], "");
    this.columns = [];
    this.progress = h("div", {});
    this.columnPlace = h("details", { "data-pointer": "/columns" }, h("summary", {}, "Which column is what"));
    this.columnPlace.addEventListener("change", () => this.preview.look());
    this.preview = new FilePreview({ form: () => this.#previewForm(), forAll: (units) => forAll(this, units), onSeen: (seen) => this.#seen(seen) });
    this.element = this.#layout();
    this.ready = this.#lookInside();
  }

  // Bring the file in; resolves to whether that went well.
  async bringIn() {
    try {
      const job = this.format === "json" ? await post("/experiments", await this.#body()) : await upload("/experiments/files", this.#form());
      const { href } = await followJob(job, this.progress);
      this.element.remove();
      this.onGone();
      await this.onMade(href);
      return true;
    } catch (problem) {
      if (!problem.title) throw problem;
      showProblem(problem, { place: this.progress, form: this.element });
      return false;
    }
  }

  #layout() {
    const variables = this.plant.schedulingVariables;
    const points = this.point.map((input, index) =>
      field(labelled(variables[index].name, variables[index].unit), input, {
        hint: `from ${exact(variables[index].minimum)} to ${exact(variables[index].maximum)}, held still`, pointer: `/operatingPoint/${index}` }));
    const json = this.format === "json";
    return h("form", { class: "panel", novalidate: true, onsubmit: (event) => event.preventDefault() },
      h("h3", { "data-pointer": "/file" }, this.file.name, h("span", { class: "quiet-text" }, ` ${bytes(this.file.size)}`)),
      h("div", { "data-pointer": "/operatingPoint" }, fields(points, field("name", this.name, { pointer: "/name" }))),
      json ? null : h("details", {}, h("summary", {}, "More about it"), fields(
        field("sample time (s)", this.sampleTime, { hint: "when the file has no time", pointer: "/sampleTimeSeconds" }),
        field("samples in one period", this.period, { hint: "of a periodic input; empty: found or none", pointer: "/periodSamples" }),
        field("table", this.group, { hint: "structure, sheet or group that is meant, e.g. data.run1", pointer: "/variableGroup" }),
        field(labelled("input level", this.plant.input?.unit), this.inputLevel, { hint: "at the operating point; empty: its mean", pointer: "/inputLevel" }),
        field(labelled("output level", this.plant.output?.unit), this.outputLevel, { hint: "when the input stands at its level; empty: its mean", pointer: "/outputLevel" }),
        field("input between its samples", this.hold, { pointer: "/inputHold" }),
        field("feedback", this.feedback, { hint: "while the record was made", pointer: "/feedback" }),
        field("design", this.design, { hint: "that this experiment carries out", pointer: "/designId" }))),
      json ? null : this.columnPlace,
      json ? null : this.preview.element,
      this.progress,
      h("div", { class: "actions" }, submitButton("Bring in", () => this.bringIn(), { type: "submit" }),
        h("button", { type: "button", class: "quiet", onclick: () => { this.element.remove(); this.onGone(); } }, "Leave out")));
  }

  // Choices of columns, by the names that the browser sees until the service has looked.
  async #lookInside() {
    const names = await columnsOf(this.file);
    this.#choices(names);
    if (this.format !== "json") await this.preview.look();
  }

  // Use units that were stated of another file, where this one has the same columns.
  take(units) {
    if (this.preview.names && this.preview.take(units, this.preview.names)) this.preview.look();
  }

  // The service knows the columns better than the browser; what is remembered of the plant is filled in.
  #seen({ columns, statedColumns, problem }) {
    const names = columns.map((column) => column.name);
    if (names.join("\n") !== this.names?.join("\n")) this.#choices(names);
    for (const one of statedColumns) {
      const [, input] = this.columns.find(([meaning]) => one.startsWith(`${meaning}=`)) ?? [];
      if (input && !input.value) input.value = one.slice(one.indexOf("=") + 1);
    }
    this.columnPlace.open = Boolean(problem) || statedColumns.length > 0;
  }

  #choices(names) {
    this.names = names;
    const hint = names ? "Columns are found by their names; say so where the names do not tell." : "Names of arrays in the file, where theirs do not tell.";
    this.columnPlace.replaceChildren(this.columnPlace.firstChild);
    const inputs = Object.keys(LABELS).map((meaning) => {
      const input = names ? select([["", "by its name"], ...names.map((name) => [name, name])], "") : textInput();
      return [meaning, input];
    });
    this.columns = inputs;
    append(this.columnPlace, [h("p", { class: "hint" }, hint, names ? ` The file has ${names.join(", ") || "no columns"}.` : ""),
      fields(inputs.map(([meaning, input]) => field(LABELS[meaning], input)))]);
  }

  #stated() {
    return { plantId: this.plant.id, operatingPoint: this.point.map(numberOf), name: this.name.value.trim() };
  }

  // What is stated of the file itself, for a look inside.
  #previewForm() {
    const form = new FormData();
    form.append("plantId", this.plant.id);
    for (const [name, input] of [["sampleTimeSeconds", this.sampleTime], ["periodSamples", this.period], ["variableGroup", this.group]]) {
      if (input.value.trim()) form.append(name, input.value.trim());
    }
    this.#appendColumns(form);
    return form;
  }

  #appendColumns(form) {
    for (const [meaning, input] of this.columns) if (input.value.trim()) form.append("columns", `${meaning}=${input.value.trim()}`);
    for (const one of this.preview.statedUnits()) form.append("units", one);
    form.append("file", this.file);
  }

  #form() {
    const form = new FormData();
    const { operatingPoint, ...stated } = this.#stated();
    const more = { sampleTimeSeconds: this.sampleTime.value, periodSamples: this.period.value, variableGroup: this.group.value.trim(), designId: this.design.value,
      inputLevel: this.inputLevel.value, outputLevel: this.outputLevel.value, inputHold: this.hold.value, feedback: this.feedback.value };
    for (const [name, value] of Object.entries({ ...stated, ...more })) if (value !== "") form.append(name, value);
    for (const value of operatingPoint) form.append("operatingPoint", value ?? "");
    this.#appendColumns(form);
    return form;
  }

  // The document in a JSON file, with what is stated here where the file does not say it.
  async #body() {
    let document;
    try {
      document = JSON.parse(await this.file.text());
    } catch (error) {
      throw Object.assign(new Error(error.message), { title: "The file is no JSON", errors: [{ pointer: "/file", detail: `the file is no JSON: ${error.message}` }] });
    }
    const { operatingPoint, ...stated } = this.#stated();
    const point = operatingPoint.some((value) => value != null) ? { operatingPoint } : {};
    return { ...stated, ...document, ...point, plantId: this.plant.id };
  }
}


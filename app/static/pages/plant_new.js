// A new plant: what is measured, what it depends on, the structure meant for it.

import { get, post } from "../js/api.js";
import { basisFields } from "../js/basis_fields.js";
import { BasisPicture } from "../js/basis_picture.js";
import { byId, h, replace } from "../js/dom.js";
import { field, fields, group, select, submitButton, textInput } from "../js/forms.js";
import { showProblem } from "../js/problems.js";
import { page } from "../js/ready.js";
import { quantitySelect } from "../js/quantities.js";
import { schedulingRows } from "../js/scheduling_rows.js";
import { structureFields } from "../js/structure_fields.js";

page(async () => {
  const { bases } = await get("/catalogue");
  const form = new PlantForm(bases);
  replace(byId("form"), form.element);
  form.changed();
});

class PlantForm {
  constructor(bases) {
    this.bases = bases;
    this.exceptions = [];
    this.name = textInput("", { required: true });
    this.description = textInput();
    this.signals = Object.fromEntries(["input", "output"].map((which) => [which, { name: textInput(), unit: textInput(), quantity: quantitySelect() }]));
    const changed = () => this.changed();
    this.variables = schedulingRows(changed);
    this.structure = structureFields(changed);
    this.basis = basisFields(bases, "/basis", changed);
    this.exceptionPlace = h("div", {});
    this.picturePlace = h("div", { "aria-live": "off" });
    this.picture = new BasisPicture(this.picturePlace);
    this.element = this.#layout();
  }

  // Bring everything that follows from the fields up to date.
  changed() {
    const variables = this.variables.value();
    this.names = variables.map((one) => one.name);
    for (const basis of [this.basis, ...this.exceptions.map((one) => one.basis)]) basis.setVariables(this.names);
    const named = variables.map((one, index) => ({ ...one, name: one.name || `variable ${index + 1}` }));
    this.picture.show({ schedulingVariables: named, basis: this.basis.value() });
  }

  value() {
    const signal = ({ name, unit, quantity }) => ({ name: name.value.trim(), unit: unit.value.trim(), ...(quantity.value ? { quantity: quantity.value } : {}) });
    return {
      name: this.name.value.trim(), description: this.description.value.trim(),
      input: signal(this.signals.input), output: signal(this.signals.output),
      schedulingVariables: this.variables.value(), structure: this.structure.value(), basis: this.basis.value(),
      coefficientBases: this.exceptions.map((one) => ({ coefficient: one.coefficient.value, basis: one.basis.value() })),
    };
  }

  #layout() {
    const signalFields = (which, example) => [
      field(`${which}: name`, this.signals[which].name, { hint: example, pointer: `/${which}/name` }),
      field(`${which}: unit`, this.signals[which].unit, { pointer: `/${which}/unit` }),
      field(`${which}: quantity`, this.signals[which].quantity, { hint: "tells a spring from a damper in a diagnosis", pointer: `/${which}/quantity` }),
    ];
    const another = h("button", { type: "button", class: "quiet", onclick: () => this.#addException() }, "Give one coefficient a basis of its own");
    return h("form", { novalidate: true, onsubmit: (event) => event.preventDefault() },
      group("What it is", fields(
        field("name", this.name, { pointer: "/name" }), field("description", this.description, { pointer: "/description" }),
        signalFields("input", "what you play, e.g. force"), signalFields("output", "what you measure, e.g. position"))),
      group("What the dynamics depend on", h("p", { class: "hint" }, "Conditions that you can hold still while measuring: the scheduling variables."), this.variables.element),
      group("Model structure", this.structure.element),
      group("How the coefficients depend on them", h("div", { class: "columns" },
        h("div", { "data-pointer": "/basis" }, this.basis.element,
          h("div", { "data-pointer": "/coefficientBases" }, this.exceptionPlace), h("p", { class: "actions" }, another)),
        this.picturePlace)),
      h("p", { class: "actions" }, submitButton("Keep this plant", () => this.#submit(), { type: "submit" })));
  }

  #addException() {
    const place = this.exceptions.length;
    const coefficient = select(this.structure.coefficients().map((name) => [name, name]));
    const basis = basisFields(this.bases, `/coefficientBases/${place}/basis`, () => {}, 0);
    this.exceptions.push({ coefficient, basis });
    basis.setVariables(this.names);
    this.#drawExceptions();
    coefficient.focus();
  }

  #drawExceptions() {
    replace(this.exceptionPlace, this.exceptions.map((one, index) => h("div", { class: "panel" },
      fields(field("coefficient", one.coefficient, { pointer: `/coefficientBases/${index}/coefficient` })), one.basis.element)),
    this.exceptions.length ? h("button", { type: "button", class: "quiet", onclick: () => { this.exceptions.pop(); this.#drawExceptions(); } }, "Remove the last of these") : null);
  }

  async #submit() {
    try {
      const made = await post("/plants", this.value());
      location.href = `/plants/${made.id}`;
    } catch (problem) {
      showProblem(problem, { place: byId("form"), form: this.element });
    }
  }
}

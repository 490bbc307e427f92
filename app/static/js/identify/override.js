// Another structure or basis than those of the plant, for this model only.

import { basisFields } from "../basis_fields.js";
import { h, replace } from "../dom.js";
import { checkbox, field } from "../forms.js";
import { structureFields } from "../structure_fields.js";

// {element, value()}: what goes in place of the plant's own, nothing where it stays.
export function override(catalogue, plant) {
  const structure = structureFields(() => {}, plant.structure);
  const basis = basisFields(catalogue.bases, "/basis", () => {});
  basis.setVariables(plant.schedulingVariables.map((one) => one.name));
  const one = optional("another structure", structure.element);
  const other = optional("another basis, for all coefficients", h("div", { "data-pointer": "/basis" }, basis.element));
  const value = () => ({
    ...(one.box.checked ? { structure: structure.value() } : {}),
    ...(other.box.checked ? { basis: basis.value(), coefficientBases: [] } : {}),
  });
  return { element: h("details", {}, h("summary", {}, "Another structure or basis than the plant's"), one.element, other.element), value };
}

function optional(label, element) {
  const box = checkbox(false);
  const place = h("div", {});
  box.addEventListener("change", () => replace(place, box.checked ? element : null));
  return { box, element: h("div", {}, field(label, box), place) };
}

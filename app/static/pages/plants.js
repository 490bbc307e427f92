// The list of plants.

import { list } from "../js/api.js";
import { byId, h, message, replace } from "../js/dom.js";
import { counted, moment } from "../js/numbers.js";
import { page } from "../js/ready.js";

page(async () => {
  const plants = await list("/plants");
  replace(byId("plants"), plants.length ? h("ul", { class: "cards" }, plants.map(card)) : message("", "There is no plant yet."));
});

function card(plant) {
  const variables = plant.schedulingVariables.map((one) => one.name).join(", ");
  const signals = plant.input ? `${plant.input.name} → ${plant.output.name}` : `${counted(plant.inputs.length, "input")}, ${counted(plant.outputs.length, "output")}`;
  return h("li", {},
    h("h2", {}, h("a", { href: `/plants/${plant.id}` }, plant.name)),
    h("p", {}, `${signals}, depending on ${variables}`),
    h("p", { class: "hint" }, `${counted(plant.parameterNames.length, "parameter")}, described ${moment(plant.createdAt)}`));
}

// The list of plants, and an example in one click.

import { get, list } from "../js/api.js";
import { byId, h, message, replace } from "../js/dom.js";
import { runJob } from "../js/jobs.js";
import { counted, moment } from "../js/numbers.js";
import { showProblem } from "../js/problems.js";
import { page } from "../js/ready.js";

page(async () => {
  const plants = await list("/plants");
  replace(byId("plants"), plants.length ? h("ul", { class: "cards" }, plants.map(card)) : message("", "There is no plant yet."));
  byId("example").addEventListener("click", (event) => makeExample(event.target));
});

async function makeExample(button) {
  button.disabled = true;
  try {
    const seed = crypto.getRandomValues(new Uint32Array(1))[0];
    const { href } = await runJob("/examples", { hiddenEffect: byId("hidden").value, seed }, byId("example-job"));
    location.href = `/plants/${(await get(href)).plantId}`;
  } catch (problem) {
    showProblem(problem, { place: byId("example-job") });
    button.disabled = false;
  }
}

function card(plant) {
  const variables = plant.schedulingVariables.map((one) => one.name).join(", ");
  const signals = plant.input ? `${plant.input.name} → ${plant.output.name}` : `${counted(plant.inputs.length, "input")}, ${counted(plant.outputs.length, "output")}`;
  return h("li", {},
    h("h2", {}, h("a", { href: `/plants/${plant.id}` }, plant.name)),
    h("p", {}, `${signals}, depending on ${variables}`),
    h("p", { class: "hint" }, `${counted(plant.parameterNames.length, "parameter")}, described ${moment(plant.createdAt)}`));
}

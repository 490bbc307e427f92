// What is known of the plant now: a model that there is, or one stated by its parameters.

import { post } from "../api.js";
import { h, replace } from "../dom.js";
import { field, fields, numberInput, numberOf, select } from "../forms.js";
import { moment } from "../numbers.js";

const STATE = "";

// {element, modelId()}: modelId() keeps a stated model first where there is none.
export function known(plant, models, chosen = null) {
  const usable = models.filter((one) => !one.stateSpace && !one.varying);
  const choices = [...usable.map((one) => [one.id, `${one.name || `${one.origin} model`}, ${moment(one.createdAt)}`]), [STATE, "a first guess, stated here"]];
  const model = select(choices, usable.some((one) => one.id === chosen) ? chosen : choices[0][0]);
  const theta = plant.parameterNames.map((name) => [name, numberInput()]);
  const noise = numberInput(null, { min: 0 });
  const place = h("div", {});
  const draw = () => replace(place, model.value === STATE ? [
    h("p", { class: "hint" }, `The parameters that you expect: the coefficient of each basis function, e.g. ${plant.parameterNames[0]} is ${plant.parameterNames[0].split("[")[0]} over function 0.`),
    fields(theta.map(([name, input], i) => field(name, input, { pointer: `/theta/${i}` })),
      field("noise variance", noise, { hint: "of the output, in its unit squared", pointer: "/noiseVariance" })),
  ] : null);
  model.addEventListener("change", draw);
  draw();
  const modelId = async () => {
    if (model.value !== STATE) return model.value;
    const body = { plantId: plant.id, name: "first guess", theta: theta.map(([, input]) => numberOf(input)), noiseVariance: numberOf(noise) };
    return (await post("/models/stated", body)).id;
  };
  return { element: h("div", {}, fields(field("model", model, { pointer: "/modelId", wide: true })), place), modelId };
}

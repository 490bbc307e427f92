// Targets about physical effects: see one of a given size, tell one from another.

import { h } from "../dom.js";
import { field, fields, numberInput, numberOf, numbersOf, select, textInput } from "../forms.js";

// See an effect of at least a size.
export function detectionFields(plant, pointer, { effects }) {
  const effect = effectSelect(effects);
  const amplitude = numberInput();
  const common = rates(pointer);
  const unit = h("span", {});
  const tell = () => { unit.textContent = unitOf(effects, effect.value); };
  effect.addEventListener("change", tell);
  tell();
  const element = fields(field("effect", effect, { pointer: `${pointer}/effect`, wide: true }),
    field("of at least", amplitude, { hint: unit, pointer: `${pointer}/amplitude` }), common.fields);
  return { element, value: () => ({ kind: "effect_detection", effect: effect.value, amplitude: numberOf(amplitude), ...common.value() }) };
}

// Tell one effect from another.
export function discriminationFields(plant, pointer, { effects }) {
  const [effect, against] = [effectSelect(effects, "delay"), effectSelect(effects, "lag")];
  const amplitude = numberInput();
  const common = rates(pointer);
  const element = fields(field("effect that is there", effect, { pointer: `${pointer}/effect`, wide: true }),
    field("to be told from", against, { pointer: `${pointer}/against`, wide: true }),
    field("of size", amplitude, { hint: "empty: as fitted to the earlier experiments", pointer: `${pointer}/amplitude` }), common.fields);
  return { element, value: () => ({ kind: "effect_discrimination", effect: effect.value, against: against.value, amplitude: numberOf(amplitude), ...common.value() }) };
}

function rates(pointer) {
  const [power, level] = [numberInput(90, { min: 0, max: 100 }), numberInput(5, { min: 0, max: 100 })];
  const parameters = textInput();
  const share = (input) => (numberOf(input) == null ? null : numberOf(input) / 100);
  return {
    fields: [
      field("its further parameters", parameters, { hint: "in the order in which a diagnosis lists them; may be empty", pointer: `${pointer}/parameters` }),
      field("power (%)", power, { hint: "how often it is seen", pointer: `${pointer}/power` }),
      field("level (%)", level, { hint: "how often something is seen that is not there", pointer: `${pointer}/level` })],
    value: () => ({ parameters: numbersOf(parameters), power: share(power), level: share(level) }),
  };
}

function effectSelect(effects, chosen = null) {
  const titles = effects.map((one) => [one.kind, one.title]).sort(([, a], [, b]) => a.localeCompare(b));
  return select(titles, titles.some(([kind]) => kind === chosen) ? chosen : titles[0][0]);
}

const unitOf = (effects, kind) => {
  const { unit, parameters } = effects.find((one) => one.kind === kind);
  const others = parameters.length ? `; further parameters: ${parameters.map((one) => one.name).join(", ")}` : "";
  return `its amplitude${unit ? `, ${unit}` : ""}${others}`;
};

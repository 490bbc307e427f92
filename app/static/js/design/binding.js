// What binds: the targets and limits that the energy would be less without.

import { h } from "../dom.js";
import { percent, pointLabel, significant } from "../numbers.js";
import { table } from "../tables.js";
import { limitText } from "./plant_limits.js";
import { targetText } from "./target_fields.js";

export function bindingTable(design, plant) {
  if (!design.binding.length) return h("p", { class: "hint" }, "Nothing binds.");
  const where = (one) => pointLabel(one.operatingPoint, plant.schedulingVariables);
  const words = {
    target: (one) => [`target ${one.targetIndex + 1}: ${targetText(design.request.targets[one.targetIndex], plant)}`, `${percent(one.multiplier)} of the energy`],
    cap: (one) => [`limit of energy at ${where(one)}`, `one unit more would save ${significant(one.multiplier)}`],
    limit: (one) => [`${limitText(design.request.limits[one.limitIndex], plant)} at ${where(one)}`, `1 % more power would save ${percent(one.multiplier / 100)} of the energy`],
  };
  const rows = design.binding.map((one) => words[one.what](one));
  return table({ caption: "What binds", columns: ["what", "what it costs"], rows, textColumns: 2 });
}

// What binds: the targets and limits that the energy would be less without.

import { h } from "../dom.js";
import { percent, pointLabel, significant } from "../numbers.js";
import { table } from "../tables.js";
import { targetText } from "./target_fields.js";

export function bindingTable(design, plant) {
  if (!design.binding.length) return h("p", { class: "hint" }, "Nothing binds.");
  const rows = design.binding.map((one) => (one.what === "target"
    ? [`target ${one.targetIndex + 1}: ${targetText(design.request.targets[one.targetIndex], plant)}`, `${percent(one.multiplier)} of the energy`]
    : [`limit of energy at ${pointLabel(one.operatingPoint, plant.schedulingVariables)}`, `one unit more would save ${significant(one.multiplier)}`]));
  return table({ caption: "What binds", columns: ["what", "what it costs"], rows, textColumns: 2 });
}

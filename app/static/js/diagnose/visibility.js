// Which effects these experiments could show at all.

import { h, replace } from "../dom.js";
import { percent, significant } from "../numbers.js";
import { table, tableBehind } from "../tables.js";
import { nameOf } from "./ranking.js";

const STATES = { visible: "visible", invisible: "invisible", notJudged: "not judged" };

export function drawVisibility(place, { visibility }) {
  const hidden = visibility.filter((one) => one.status !== "visible");
  const seen = visibility.filter((one) => one.status === "visible");
  replace(place,
    hidden.length ? h("p", {}, "That the following were not found does not mean that they are not there:") : h("p", {}, "Every effect that was to be judged could be seen."),
    hidden.length ? table({ columns: ["effect", "state", "why"], rows: hidden.map((one) => [nameOf(one), STATES[one.status], one.reason]), textColumns: 3 }) : null,
    tableBehind(() => ({
      caption: "What would be found with 90 % power by a test at 5 %, in the unit of the effect; kept: what the parameters of the model leave of it", columns: ["effect", "smallest amplitude", "kept"],
      rows: seen.map((one) => [nameOf(one), significant(one.detectableAmplitude), percent(one.kept)]) }), `${seen.length} effects that could be seen`));
}

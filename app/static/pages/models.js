// The models of a plant, newest first.

import { list } from "../js/api.js";
import { context } from "../js/context.js";
import { byId, h, message, replace } from "../js/dom.js";
import { effectsText, indexed, lineage, titleOf } from "../js/models/versions.js";
import { moment } from "../js/numbers.js";
import { page } from "../js/ready.js";
import { table } from "../js/tables.js";

const at = (rest) => `/plants/${context.plantId}/${rest}`;

page(async () => {
  const models = await list("/models", { plantId: context.plantId });
  const identify = h("p", { class: "actions" }, h("a", { class: "button", href: at("identify") }, "Identify a model"));
  if (!models.length) return replace(byId("models"), message("", "There is no model yet."), identify);
  const known = indexed(models);
  const rows = models.map((one) => [
    h("a", { href: at(`models/${one.id}`) }, titleOf(one)), String(lineage(one, known).length), effectsText(one), stateOf(one), moment(one.createdAt),
    h("a", { href: at(`compare?model=${one.id}`) }, "Compare"),
  ]);
  return replace(byId("models"), identify,
    table({ caption: "Newest first", columns: ["model", "version", "effects", "state", "made", "next"], rows, textColumns: 6 }));
});

function stateOf(model) {
  const found = model.outcome.status === "converged" ? "" : `${model.outcome.status.replaceAll("_", " ")}, `;
  return `${found}${model.stable ? "stable" : "not stable"}`;
}

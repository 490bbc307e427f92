// What was deleted, with the moment; each can be brought back.

import { get, list, post } from "../js/api.js";
import { byId, h, message, replace } from "../js/dom.js";
import { submitButton } from "../js/forms.js";
import { pageOf, wordOf } from "../js/manage/resource.js";
import { moment } from "../js/numbers.js";
import { showProblem } from "../js/problems.js";
import { page } from "../js/ready.js";
import { table } from "../js/tables.js";

page(show);

async function show() {
  const found = await list("/bin");
  if (!found.length) return replace(byId("deleted"), message("", "The bin is empty."));
  const rows = found.map((one) => [one.resource.name || wordOf(one.resource.collection), wordOf(one.resource.collection), moment(one.deletedAt), one.others ? `${one.others} more` : "nothing",
    submitButton("Restore", () => restore(one), { class: "quiet", "aria-label": `Restore ${one.resource.name || wordOf(one.resource.collection)}` })]);
  return replace(byId("deleted"), table({ caption: "Newest first", columns: ["name", "what", "deleted", "went with it", "bring back"], rows, textColumns: 5 }));
}

async function restore({ id, resource }) {
  try {
    await post(`/bin/${id}/restoration`, undefined);
    const back = pageOf(resource.collection, await get(resource.href));
    const name = resource.name || `the ${wordOf(resource.collection)}`;
    replace(byId("restored"), message("success", h("p", {}, "Restored: ", back ? h("a", { href: back }, name) : name, ".")));
    await show();
  } catch (problem) {
    showProblem(problem, { place: byId("restored") });
  }
}

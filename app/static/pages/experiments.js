// The experiments of a plant: files in, operating points, the list.

import { list } from "../js/api.js";
import { context } from "../js/context.js";
import { byId, h, message, replace } from "../js/dom.js";
import { FileCard } from "../js/file_card.js";
import { formatOf } from "../js/file_columns.js";
import { submitButton } from "../js/forms.js";
import { moment, pointLabel, quantity } from "../js/numbers.js";
import { operatingPoints } from "../js/operating_points.js";
import { page } from "../js/ready.js";
import { plant } from "../js/shell.js";
import { table } from "../js/tables.js";

const cards = new Set();
let described = null;

page(async () => {
  described = await plant;
  const designs = await list("/designs", { plantId: context.plantId }, 100);
  installDrop((files) => take(files, designs));
  await refresh();
});

function installDrop(take) {
  const place = byId("drop");
  const stop = (event) => event.preventDefault();
  for (const name of ["dragenter", "dragover"]) {
    place.addEventListener(name, (event) => { stop(event); place.classList.add("over"); });
  }
  place.addEventListener("dragleave", () => place.classList.remove("over"));
  place.addEventListener("drop", (event) => {
    stop(event);
    place.classList.remove("over");
    take([...event.dataTransfer.files]);
  });
  byId("files").addEventListener("change", (event) => {
    take([...event.target.files]);
    event.target.value = "";
  });
}

function take(files, designs) {
  for (const file of files) {
    if (!formatOf(file.name)) {
      byId("incoming").append(message("problem", `${file.name}: files of this kind are not read; .csv, .txt, .npz, .mat, .xlsx, .h5, .json and others are.`));
      continue;
    }
    const card = new FileCard(file, described, designs, {
      onMade: refresh, onGone: () => { cards.delete(card); drawAll(); }, forAll: (from, units) => [...cards].filter((one) => one !== from).forEach((one) => one.take(units)),
    });
    cards.add(card);
    byId("incoming").append(card.element);
  }
  drawAll();
}

// One button for several files.
function drawAll() {
  byId("all")?.remove();
  if (cards.size < 2) return;
  const button = submitButton(`Bring in all ${cards.size} files`, () => Promise.all([...cards].map((card) => card.bringIn())));
  byId("incoming").prepend(h("p", { class: "actions", id: "all" }, button));
}

async function refresh() {
  const found = await list("/experiments", { plantId: context.plantId });
  replace(byId("experiments"), h("h2", {}, "Experiments"), found.length ? listed(found) : message("", "There is no experiment yet."));
  const local = found.filter((one) => one.operatingPoint);
  replace(byId("where"));
  const kinds = [["records", "timeRecord"], ["frequency responses", "frequencyResponse"], ["responses of several channels", "matrixFrequencyResponse"]];
  operatingPoints(byId("where"), described.schedulingVariables,
    kinds.map(([name, kind]) => ({ name, points: local.filter((one) => one.kind === kind).map((one) => one.operatingPoint) })),
    "Where was measured.");
}

const KINDS = { timeRecord: "record", frequencyResponse: "frequency response", matrixFrequencyResponse: "frequency response, several channels", varyingRecord: "record with varying scheduling" };

function listed(found) {
  const unit = described.output?.unit ?? "";
  const rows = found.map((one) => [
    h("a", { href: `/plants/${context.plantId}/experiments/${one.id}` }, one.name || one.fileName || one.id.slice(0, 8)),
    one.operatingPoint ? pointLabel(one.operatingPoint, described.schedulingVariables) : "varies",
    KINDS[one.kind],
    String(one.understood.frequencyCount),
    quantity(one.understood.noiseLevel, unit, 2),
    one.understood.warnings.length ? String(one.understood.warnings.length) : "none",
    moment(one.createdAt),
  ]);
  return table({ columns: ["name", "operating point", "kind", "lines", "noise level", "warnings", "brought in"], rows, textColumns: 3 });
}

// All jobs, live: those that go on are watched, and new ones are looked for. Each leads to its plant and its result.

import { list, pause } from "../js/api.js";
import { byId, h, message, replace } from "../js/dom.js";
import { plantLink, resultLink } from "../js/job_links.js";
import { isFinal, jobCard, kindOf, stateOf } from "../js/jobs.js";
import { indexed } from "../js/models/versions.js";
import { moment } from "../js/numbers.js";
import { page } from "../js/ready.js";
import { table } from "../js/tables.js";

const MOST_WATCHED = 3; // a browser keeps few connections open to one server
const SECONDS = 3;
const watched = new Map();

page(async () => {
  await look();
  goOn();
});

async function goOn() {
  for (;;) {
    await pause(1000 * SECONDS);
    if (!document.hidden) await look().catch(() => {});
  }
}

async function look() {
  const [jobs, found] = await Promise.all([list("/jobs", {}, 200), list("/plants")]);
  const plants = indexed(found);
  drawRunning(jobs.filter((job) => !isFinal(job)), plants);
  drawEnded(jobs.filter(isFinal), plants);
}

function drawRunning(jobs, plants) {
  const place = byId("running");
  for (const [id, card] of watched) {
    if (jobs.some((job) => job.id === id)) continue;
    card.stop();
    card.element.remove();
    watched.delete(id);
  }
  const waiting = jobs.filter((job) => !watched.has(job.id)).reverse();
  for (const job of waiting.slice(0, Math.max(MOST_WATCHED - watched.size, 0))) {
    const card = jobCard(job, { link: (one) => plantLink(one, plants) });
    watched.set(job.id, card);
    card.ended.then(look, () => {});
  }
  const others = waiting.filter((job) => !watched.has(job.id));
  replace(place, [...watched.values()].map((card) => card.element),
    others.length ? h("p", { class: "hint" }, `${others.length} more wait.`) : null,
    jobs.length ? null : message("", "Nothing is running."));
}

function drawEnded(jobs, plants) {
  const place = byId("ended");
  if (!jobs.length) return replace(place, h("p", { class: "hint" }, "No job has ended yet."));
  const shown = JSON.stringify(jobs.map((job) => [job.id, plants.get(job.plantId)?.name]));
  if (place.dataset.shown === shown) return null;
  place.dataset.shown = shown;
  const rows = jobs.map((job) => [kindOf(job), plantLink(job, plants) ?? "–", stateOf(job), moment(job.finishedAt), resultLink(job) ?? job.problem?.detail ?? "–"]);
  return replace(place, table({ columns: ["job", "plant", "how it ended", "when", "what came of it"], rows, textColumns: 5 }));
}

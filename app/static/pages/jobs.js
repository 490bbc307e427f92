// All jobs, live: those that go on are watched, and new ones are looked for.

import { list, pause } from "../js/api.js";
import { byId, h, message, replace } from "../js/dom.js";
import { isFinal, jobCard, kindOf, stateOf } from "../js/jobs.js";
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
  const jobs = await list("/jobs", {}, 200);
  drawRunning(jobs.filter((job) => !isFinal(job)));
  drawEnded(jobs.filter(isFinal));
}

function drawRunning(jobs) {
  const place = byId("running");
  for (const [id, card] of watched) {
    if (jobs.some((job) => job.id === id)) continue;
    card.stop();
    card.element.remove();
    watched.delete(id);
  }
  const waiting = jobs.filter((job) => !watched.has(job.id)).reverse();
  for (const job of waiting.slice(0, Math.max(MOST_WATCHED - watched.size, 0))) {
    const card = jobCard(job);
    watched.set(job.id, card);
    card.ended.then(look, () => {});
  }
  const others = waiting.filter((job) => !watched.has(job.id));
  replace(place, [...watched.values()].map((card) => card.element),
    others.length ? h("p", { class: "hint" }, `${others.length} more wait.`) : null,
    jobs.length ? null : message("", "Nothing is running."));
}

function drawEnded(jobs) {
  const place = byId("ended");
  if (!jobs.length) return replace(place, h("p", { class: "hint" }, "No job has ended yet."));
  const rows = jobs.map((job) => [kindOf(job), stateOf(job), moment(job.finishedAt), job.problem?.detail ?? ""]);
  if (place.dataset.rows === JSON.stringify(rows)) return null;
  place.dataset.rows = JSON.stringify(rows);
  return replace(place, table({ columns: ["job", "how it ended", "when", "what went wrong"], rows, textColumns: 4 }));
}

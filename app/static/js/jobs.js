// Jobs: submitted, watched live, cancelled; a failure says what happened and what to change.

import { ApiProblem, get, post } from "./api.js";
import { announce, h, replace } from "./dom.js";
import { events } from "./events.js";
import { percent } from "./numbers.js";
import { problemBox } from "./problems.js";

const FINAL = ["succeeded", "failed", "cancelled"];
export const KINDS = {
  experiment: "Reading an experiment", preview: "Looking into a file", design: "Designing experiments", signals: "Making signals",
  identification: "Identifying a model", stateSpaceIdentification: "Identifying a state-space model",
  example: "Making an example", measurement: "Playing signals on the simulated plant", comparison: "Comparing model and measurements", diagnosis: "Looking for what is missing", extension: "Adding an effect", report: "Drawing the report", staircase: "Adding effects until only noise is left",
};
const STATES = { queued: "waiting", running: "running", succeeded: "done", failed: "failed", cancelled: "cancelled" };

export const isFinal = (job) => FINAL.includes(job.state);
export const kindOf = (job) => KINDS[job.kind] ?? job.kind.replaceAll("_", " ");
export const stateOf = (job) => STATES[job.state];

// Submit work and show its progress in `place`; resolves to what it made ({kind, id, href}), or throws an ApiProblem.
export async function runJob(path, body, place) {
  return followJob(await post(path, body), place);
}

// Show a job in `place` until it has ended; resolves to what it made, or throws an ApiProblem.
export async function followJob(job, place) {
  const card = jobCard(job);
  place.prepend(card.element);
  const ended = await card.ended;
  if (ended.state === "succeeded") {
    card.element.remove();
    announce(`${kindOf(job)}: done`);
    return ended.result;
  }
  announce(`${kindOf(job)}: ${stateOf(ended)}`);
  if (ended.state === "failed") card.element.remove();
  throw new ApiProblem(ended.problem ?? { status: 0, title: "Cancelled", detail: "The job was cancelled." });
}

// An element that shows a job as it goes on, and a promise of the job as it ended.
export function jobCard(job, { link = null } = {}) {
  const element = h("div", { class: "job", "data-job": job.id });
  const stop = new AbortController();
  const draw = (now) => replace(element, content(now, link));
  draw(job);
  return { element, ended: isFinal(job) ? Promise.resolve(job) : watched(job, draw, stop.signal), stop: () => stop.abort() };
}

async function watched(job, draw, signal) {
  let now = job;
  for await (const event of events(`/jobs/${job.id}/events`, isFinal, signal)) {
    now = { ...now, ...event };
    draw(now);
  }
  return isFinal(now) ? get(`/jobs/${job.id}`) : now;
}

function content(job, link) {
  const running = !isFinal(job);
  const title = `${kindOf(job)}: ${stateOf(job)}`;
  return [
    h("div", { class: "job-line" }, h("strong", {}, title), link?.(job),
      running ? h("button", { type: "button", class: "quiet", onclick: (event) => cancel(job, event.target) }, "Cancel") : null),
    running ? h("progress", { max: 1, value: job.progress.fraction, "aria-label": title }) : null,
    running ? h("p", { class: "quiet-text" }, `${percent(job.progress.fraction, 2)} ${job.progress.message}`) : null,
    job.attempts > 1 ? h("p", { class: "quiet-text" }, `started ${job.attempts} times, because the server was restarted`) : null,
    job.problem ? problemBox(job.problem) : null,
  ];
}

async function cancel(job, button) {
  button.disabled = true;
  await post(`/jobs/${job.id}/cancellation`, {}).catch((error) => {
    if (error.status !== 409) throw error;
  });
}

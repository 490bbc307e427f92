// Requests to /v1. Whatever is no success is thrown as an ApiProblem.

import { askForToken, authorization } from "./token.js";

// A problem document of the service, or what stands for one when there is no answer.
export class ApiProblem extends Error {
  constructor(problem) {
    super(problem.detail ?? problem.title);
    this.status = problem.status;
    this.title = problem.title;
    this.detail = problem.detail;
    this.errors = problem.errors ?? []; // [{pointer, detail, location}]
  }
}

// One resource or list; `query` values may be arrays; null ones are left out.
export async function get(path, query = {}, options = {}) {
  return (await request(path + search(query), options)).json();
}

// Every item of a list, page by page, up to `most`.
export async function list(path, query = {}, most = 1000) {
  const items = [];
  let cursor = null;
  do {
    const page = await get(path, { limit: Math.min(most - items.length, 500), ...query, cursor });
    items.push(...page.items);
    cursor = page.nextCursor;
  } while (cursor && items.length < most);
  return items;
}

// Send a document. A key makes the server do it once, even when the answer gets lost and the request is repeated.
export async function post(path, body, { key = newKey(), ...options } = {}) {
  const headers = { "Content-Type": "application/json", "Idempotency-Key": key };
  return (await request(path, { method: "POST", headers, body: JSON.stringify(body), repeat: true, ...options })).json();
}

// Send a form with files (FormData).
export async function upload(path, form, { key = newKey() } = {}) {
  return (await request(path, { method: "POST", headers: { "Idempotency-Key": key }, body: form, repeat: true })).json();
}

// Save what a path answers with as a file, under the name that the server gives it.
export async function download(path, query = {}) {
  const answer = await request(path + search(query));
  const name = /filename="([^"]+)"/.exec(answer.headers.get("Content-Disposition") ?? "")?.[1] ?? "download";
  save(await answer.blob(), name);
}

// Save something made here as a file.
export function save(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

// The answer itself, for streams and files. 401 asks for the token and goes on.
export async function request(path, { repeat = false, headers = {}, ...options } = {}) {
  const send = () => fetch(`/v1${path.replace(/^\/v1/, "")}`, { ...options, headers: { ...headers, ...authorization() } });
  let answer;
  try {
    answer = await send().catch((error) => (repeat && error.name === "TypeError" ? pause(500).then(send) : Promise.reject(error)));
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new ApiProblem({ status: 0, title: "No answer", detail: "The server does not answer. Is it running?" });
  }
  if (answer.status === 401) {
    await askForToken();
    return request(path, { repeat, headers, ...options });
  }
  if (!answer.ok) throw new ApiProblem(await problemOf(answer));
  return answer;
}

function search(query) {
  const pairs = Object.entries(query).flatMap(([name, value]) => [value].flat().map((one) => [name, one]));
  const given = pairs.filter(([, value]) => value != null);
  return given.length ? `?${new URLSearchParams(given)}` : "";
}

async function problemOf(answer) {
  const unreadable = { status: answer.status, title: answer.statusText, detail: `The server answers ${answer.status}.` };
  return answer.json().catch(() => unreadable);
}

// crypto.randomUUID is there on secure origins only, which a server in the local network is not.
function newKey() {
  return [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

export const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

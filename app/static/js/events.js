// Server-sent events read with fetch, because EventSource cannot send a token. Goes on where it broke off.

import { ApiProblem, pause, request } from "./api.js";

const LONGEST_PAUSE = 5000;

// The data of each event of a stream; `isLast` says after which one it ends.
export async function* events(path, isLast, signal) {
  let last = "0";
  let wait = 250;
  while (!signal?.aborted) {
    try {
      const answer = await request(path, { signal, headers: { Accept: "text/event-stream", "Last-Event-ID": last } });
      for await (const event of parsed(answer.body)) {
        wait = 250;
        last = event.id ?? last;
        const data = JSON.parse(event.data);
        yield data;
        if (isLast(data)) return;
      }
    } catch (error) {
      if (error.name === "AbortError") return;
      if (error instanceof ApiProblem && error.status >= 400 && error.status < 500) throw error;
    }
    await pause(wait);
    wait = Math.min(2 * wait, LONGEST_PAUSE);
  }
}

async function* parsed(body) {
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  try {
    for (;;) {
      const { value, done } = await reader.read();
      if (done) return;
      rest += value;
      const blocks = rest.split(/\r?\n\r?\n/);
      rest = blocks.pop();
      for (const event of blocks.map(fields)) if (event.data !== undefined) yield event;
    }
  } finally {
    reader.cancel().catch(() => {});
  }
}

function fields(block) {
  const found = {};
  for (const line of block.split(/\r?\n/)) {
    const [, name, value] = /^([a-z]+): ?(.*)$/.exec(line) ?? [];
    if (name) found[name] = name === "data" && found.data !== undefined ? `${found.data}\n${value}` : value;
  }
  return found;
}

// What a measurement file holds, as far as a browser can see it: the names of its columns or arrays.

// What a column may be, as the service calls it and in words.
export const LABELS = {
  time: "time (s)", input: "input", output: "output", frequency: "frequency", frequenciesRadPerSecond: "frequency (rad/s)", frequencyHz: "frequency (Hz)",
  response: "response (complex)", responseRe: "response: real part", responseIm: "response: imaginary part", "-responseIm": "response: minus imaginary part",
  magnitude: "magnitude", phase: "phase", variance: "variance", deviation: "standard deviation", coherence: "coherence", repeat: "number of the repeat", ignored: "left out",
};
const ENDINGS = /\.(json|csv|tsv|txt|dat|asc|prn|data|tab|dta|mpt|z|zpw|npz|mat|xlsx|xlsm|parquet|pq|feather|arrow|ipc|h5|hdf5|hdf|[szy]\dp|ts|uff|unv|uf58|bunv|tdms|mf4|mdf)$/i;

export const formatOf = (name) => ENDINGS.exec(name)?.[1].toLowerCase() ?? null;

// The names of columns (csv) or arrays (npz); null where they cannot be seen.
export async function columnsOf(file) {
  const format = formatOf(file.name);
  if (["csv", "tsv", "txt"].includes(format)) return headOf(await file.slice(0, 65_536).text());
  if (format === "npz") return membersOf(new DataView(await file.arrayBuffer()));
  return null;
}

function headOf(text) {
  const line = text.replace(/^\uFEFF/, "").trimStart().split(/\r?\n/, 1)[0];
  const separator = [",", ";", "\t"].reduce((best, one) => (line.split(one).length > line.split(best).length ? one : best));
  return line.split(separator).map((name) => name.trim().replace(/^"|"$/g, "")).filter(Boolean).slice(0, 100);
}

// The names in the central directory of a zip; none where it is damaged.
function membersOf(data) {
  const names = [];
  let end = data.byteLength - 22;
  while (end >= 0 && data.getUint32(end, true) !== 0x06054b50) end -= 1;
  if (end < 0) return names;
  let position = data.getUint32(end + 16, true);
  while (position + 46 <= data.byteLength && data.getUint32(position, true) === 0x02014b50) {
    const length = data.getUint16(position + 28, true);
    const name = new TextDecoder().decode(new Uint8Array(data.buffer, position + 46, Math.min(length, data.byteLength - position - 46)));
    names.push(name.replace(/\.npy$/, ""));
    position += 46 + length + data.getUint16(position + 30, true) + data.getUint16(position + 32, true);
  }
  return names;
}

// An operating point in the name of a file, such as 5.5 in "noise_at_5.5.csv"; null when there is none.
export function pointInName(name, variables) {
  const numbers = name.replace(/\.\w+$/, "").match(/-?\d+(\.\d+)?/g)?.map(Number) ?? [];
  const last = numbers.slice(-variables.length);
  const inside = last.every((value, index) => value >= variables[index].minimum && value <= variables[index].maximum);
  return last.length === variables.length && inside ? last : null;
}

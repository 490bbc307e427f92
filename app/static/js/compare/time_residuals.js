// What a model leaves of a record along varying scheduling, over time.

import { significant } from "../numbers.js";
import { seriesColour } from "../palette.js";
import { axis, plot, thinned } from "../plots.js";

export function timeResidualPlot(place, { sampleTimeSeconds, residual, outputNumber }, title) {
  const time = residual.map((_, i) => i * sampleTimeSeconds);
  return plot(place, {
    caption: `What is left of output ${outputNumber} in ${title}, over time, in standard deviations of the noise where those are known.`, height: 300,
    draw: () => ({ data: [{ ...thinned(time, residual), mode: "lines", showlegend: false, line: { color: seriesColour(0), width: 1.2 } }], layout: { xaxis: axis("time (s)"), yaxis: axis("left over") } }),
    table: () => ({ columns: ["time (s)", "left over"], rows: time.map((t, i) => [significant(t, 5), significant(residual[i])]) }),
  });
}

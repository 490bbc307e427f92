// The experiments that would tell the announced effects apart, ready to be designed.

import { context } from "../context.js";
import { h, message, replace } from "../dom.js";
import { submitButton } from "../forms.js";
import { runJob } from "../jobs.js";
import { counted } from "../numbers.js";
import { showProblem } from "../problems.js";

// Offer the deciding design of a diagnosis, where there is one; jobPlace: where progress is shown.
export function drawDeciding(place, { decidingDesign: request }, jobPlace) {
  if (!request) return;
  const design = async () => {
    try {
      const { id } = await runJob("/designs", request, jobPlace);
      location.href = `/plants/${context.plantId}/design/${id}`;
    } catch (problem) {
      if (!problem.title) throw problem;
      showProblem(problem, { place: jobPlace });
    }
  };
  const points = request.operatingPoints.points?.length;
  const where = points ? ` at ${counted(points, "operating point")}, no stronger than what was played,` : "";
  replace(place, message("", h("p", {}, h("strong", {}, "An experiment can decide. ")),
    h("p", {}, `The least energy that tells these effects apart${where} can be designed from what is known now.`),
    h("p", { class: "actions" }, submitButton("Design the deciding experiment", design))));
}

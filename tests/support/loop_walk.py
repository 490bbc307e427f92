"""Walks every step of the loop with a model of a structure, and tells of each whether it works or why not."""

from collections.abc import Callable
from dataclasses import dataclass, field

from tests.support.api import Api, JobFailedError, Json
from tests.support.loop_plants import STEP, LoopPlant

STEPS = ("identify", "compare", "diagnose", "extend", "design", "play", "simulate", "report")
NEXT = "lag"
WORKS = ""


class RefusedError(Exception):
    """A step that the service does not take."""


@dataclass
class Walk:
    """The cells of one structure: "" where a step works, else what the service says against it."""

    api: Api
    of: LoopPlant
    cells: dict[tuple[bool, str], str] = field(default_factory=dict)

    def walked(self) -> dict[tuple[bool, str], str]:
        """All steps without an effect in the model, then with one."""
        self.plant = self.api.post("/plants", self.of.description())
        self.fitted = self._brought_in(self.of.fitted(self.plant))
        self.still = self.fitted if self.of.response else self._brought_in(self.of.held_still(self.plant))
        model = self._tried(False, "identify", self._identified)
        assert model is not None, self.cells
        grown = self._loop(False, model)
        if grown is None:
            missing = self.cells[False, "extend"]
            self.cells |= {(True, step): missing for step in STEPS}
        else:
            self._tried(True, "identify", lambda: self._identified(priorModelId=grown["id"]))
            self._loop(True, grown)
        return self.cells

    def _brought_in(self, bodies: list[Json]) -> list[str]:
        return [self.api.made("/experiments", body)["id"] for body in bodies]

    def _made(self, path: str, body: Json) -> Json:
        answer = self.api.http.post(path, json=body)
        if answer.status_code != 202:
            raise RefusedError(_reason(answer.json()))
        return self.api.result(answer.json())

    def _identified(self, **more: str) -> Json:
        which: Json = {"experimentIds": self.fitted} if self.of.response else {"experimentId": self.fitted[0]}
        return self._made("/models", {"plantId": self.plant["id"], **which, **self.of.request, **more})

    def _loop(self, grown: bool, model: Json) -> Json | None:
        asked = {"modelId": model["id"], "experimentIds": self.still}
        own = f"/models/{model['id']}"
        self._tried(grown, "compare", lambda: self._made("/comparisons", asked))
        self._tried(grown, "diagnose", lambda: self._made("/diagnoses", {**asked, "effects": [self.of.effect, NEXT]}))
        effect = NEXT if grown else self.of.effect
        extended = {"effect": effect, "experimentIds": self.still}
        version = self._tried(grown, "extend", lambda: self._made(f"{own}/extensions", extended))
        design = self._tried(grown, "design", lambda: self._made("/designs", self._design(model)))
        if design is None:
            self.cells[grown, "play"] = self.cells[grown, "design"]
        else:
            signals = f"/designs/{design['id']}/signals"
            self._tried(grown, "play", lambda: self._made(signals, {"seed": 1}))
        self._tried(grown, "simulate", lambda: self._made(f"{own}/simulations", self._excitation()))
        self._tried(grown, "report", lambda: self._made(f"{own}/reports", {}))
        return version

    def _tried(self, grown: bool, step: str, make: Callable[[], Json]) -> Json | None:
        try:
            found = make()
        except JobFailedError as failed:
            self.cells[grown, step] = _reason(failed.problem)
        except RefusedError as refused:
            self.cells[grown, step] = str(refused)
        else:
            self.cells[grown, step] = WORKS
            return found
        return None

    def _design(self, model: Json) -> Json:
        sampled = self.of.structure.get("sampleTimeSeconds")
        targets = [1.5 * one for one in model.get("standardDeviations") or [1.0] * len(model["theta"])]
        return {
            "plantId": self.plant["id"],
            "modelId": model["id"],
            "operatingPoints": {"kind": "gridAxes", "axes": [{"minimum": 0.0, "maximum": 1.0, "count": 3}]},
            "targets": [{"kind": "parameter_deviation", "standardDeviations": targets}],
            "spectrumFamily": {"kind": "lines", "samples": 128},
            "samples": 512,
            "noiseVariance": 1e-4,
            **({} if sampled else {"sampleTimeSeconds": STEP}),
        }

    def _excitation(self) -> Json:
        pulse = [1.0] * 8 + [-1.0] * 24
        inputs = self.of.channels[1]
        if inputs > 1:
            ramp = [i / 31 for i in range(32)]
            return {"excitation": {"kind": "given", "inputs": [pulse] * inputs, "scheduling": [ramp]}}
        step = self.of.structure.get("sampleTimeSeconds", STEP)
        periodic = {"kind": "periodic", "input": pulse, "sampleTimeSeconds": step, "operatingPoints": [[0.5]]}
        return {"excitation": periodic}


def _reason(problem: Json) -> str:
    errors = problem.get("errors") or []
    if errors and errors[0]["detail"] == "Extra inputs are not permitted":
        return f"requests of this kind have no {errors[0]['pointer'][1:]}; identify from the data themselves"
    return str(errors[0]["detail"] if errors else problem.get("detail"))

"""A small HTTP client of the service, for tests that look at what it answers."""

from dataclasses import dataclass
from typing import Any

import httpx

from tests.support.patience import PATIENCE, until

Json = dict[str, Any]


class JobFailedError(AssertionError):
    """A job did not succeed; `problem` says why."""

    def __init__(self, job: Json) -> None:
        super().__init__(f"the job {job['kind']} {job['state']}: {job.get('problem')}")
        self.problem: Json = job.get("problem", {})


@dataclass
class Api:
    """Requests to one server. Answers that are no success raise AssertionError with the problem in it."""

    url: str

    def __post_init__(self) -> None:
        limits = httpx.Limits(keepalive_expiry=2.0)  # sooner than the server closes idle connections
        self.http = httpx.Client(base_url=f"{self.url}/v1", timeout=PATIENCE, limits=limits)

    def get(self, path: str, **query: Any) -> Json:
        return self._json(self.http.get(self._path(path), params=query))

    def download(self, path: str, **query: Any) -> bytes:
        answer = self.http.get(self._path(path), params=query)
        assert answer.status_code == 200, answer.text
        return answer.content

    def post(self, path: str, body: Any) -> Json:
        return self._json(self.http.post(self._path(path), json=body))

    def made(self, path: str, body: Any) -> Json:
        """Start a job, wait for it, and get what it made; raises JobFailedError when it fails."""
        return self.result(self.post(path, body))

    def uploaded(self, name: str, content: bytes, **fields: Any) -> Json:
        """Bring in a file as an experiment."""
        answer = self.http.post("/experiments/files", data=fields, files={"file": (name, content)})
        return self.result(self._json(answer))

    def result(self, job: Json) -> Json:
        return self.get(self.finished(job)["result"]["href"])

    def finished(self, job: Json) -> Json:
        """Wait for a job to succeed."""
        job = until(lambda: self._final(job["id"]), f"the end of {job}")
        if job["state"] != "succeeded":
            raise JobFailedError(job)
        return job

    def _final(self, job_id: str) -> Json | None:
        job = self.get(f"/jobs/{job_id}")
        return None if job["state"] in ("queued", "running") else job

    def refused(self, path: str, body: Any) -> Json:
        """The problem that a body is answered with; it must be a 4xx one."""
        return self.problem(self.http.post(self._path(path), json=body))

    @staticmethod
    def problem(answer: httpx.Response) -> Json:
        assert 400 <= answer.status_code < 500, (answer.status_code, answer.text)
        assert answer.headers["content-type"].startswith("application/problem+json")
        problem: Json = answer.json()
        assert problem["status"] == answer.status_code
        return problem

    @staticmethod
    def _path(path: str) -> str:
        return path.removeprefix("/v1")

    @staticmethod
    def _json(answer: httpx.Response) -> Json:
        assert answer.status_code in (200, 201, 202), (answer.status_code, answer.text)
        result: Json = answer.json()
        return result


def pointers(problem: Json) -> list[str]:
    """The fields that a problem points to."""
    return [error["pointer"] for error in problem["errors"]]

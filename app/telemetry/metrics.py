"""Figures of the running service, as Prometheus reads them."""

import logging
from collections.abc import Callable, Iterator, Mapping

from prometheus_client import CollectorRegistry, Counter, Histogram, generate_latest
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.registry import Collector

logger = logging.getLogger(__name__)
MEDIA_TYPE = "text/plain; version=0.0.4; charset=utf-8"
SECONDS = (0.005, 0.01, 0.025, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0)


class Metrics:
    """Requests by route as they are answered; the rest is looked up when it is asked for.

    `gauges`: by name, its meaning, the name of its label ("" for none) and how to look it up.
    """

    def __init__(self, gauges: "Mapping[str, Gauge]") -> None:
        self._registry = CollectorRegistry()
        labels = ("method", "route")
        self._requests = Counter(
            "lpv_oed_requests", "Requests that were answered", (*labels, "status"), registry=self._registry
        )
        self._seconds = Histogram(
            "lpv_oed_request_seconds", "Time to an answer", labels, buckets=SECONDS, registry=self._registry
        )
        self._registry.register(_LookedUp(gauges))

    def answered(self, method: str, route: str, status: int, seconds: float) -> None:
        """One request was answered; `route` is the path with the names of its parameters."""
        self._requests.labels(method, route, str(status)).inc()
        self._seconds.labels(method, route).observe(seconds)

    def text(self) -> bytes:
        """All figures in the text format of Prometheus."""
        return generate_latest(self._registry)


Gauge = tuple[str, str, Callable[[], Mapping[str, float]]]


class _LookedUp(Collector):
    def __init__(self, gauges: Mapping[str, Gauge]) -> None:
        self._gauges = gauges

    def describe(self) -> list[GaugeMetricFamily]:
        return []

    def collect(self) -> Iterator[GaugeMetricFamily]:
        for name, (meaning, label, look) in self._gauges.items():
            family = GaugeMetricFamily(name, meaning, labels=[label] if label else [])
            try:
                found = look()
            except Exception as error:  # what cannot be looked up is left out, the rest is still told
                logger.warning("%s cannot be looked up: %s", name, error)
                continue
            for value_of_label, value in found.items():
                family.add_metric([value_of_label] if label else [], value)
            yield family

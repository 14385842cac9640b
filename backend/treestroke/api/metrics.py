"""Metrics for Prometheus."""

from collections.abc import Iterator

from fastapi import FastAPI
from prometheus_client import REGISTRY
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.registry import Collector
from prometheus_fastapi_instrumentator import Instrumentator

from treestroke.service.dispatch import queue_figures
from treestroke.store.scope import SERVICE


class _Queue(Collector):
    """Reads the queue's figures from the database whenever they are asked for."""

    def __init__(self, app: FastAPI) -> None:
        self._app = app

    def collect(self) -> Iterator[GaugeMetricFamily]:
        resources = getattr(self._app.state, "resources", None)
        for name, (about, value) in (queue_figures(resources.database.of(SERVICE)) if resources else {}).items():
            yield GaugeMetricFamily(f"treestroke_{name}", about, value)


def add_metrics(app: FastAPI) -> None:
    """Count requests by route, and serve all metrics at /metrics."""
    Instrumentator(excluded_handlers=["/metrics"]).instrument(app).expose(app, include_in_schema=False)
    REGISTRY.register(_Queue(app))

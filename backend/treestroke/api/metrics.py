"""Metrics for Prometheus."""

from collections.abc import Iterator
from contextlib import contextmanager

import structlog
from fastapi import FastAPI
from prometheus_client import REGISTRY, start_http_server
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.registry import Collector
from prometheus_fastapi_instrumentator import Instrumentator
from sqlalchemy.exc import SQLAlchemyError

from treestroke.service.dispatch import queue_figures
from treestroke.settings import Settings
from treestroke.store.scope import SERVICE

log = structlog.get_logger()


class _Queue(Collector):
    """Reads the queue's figures from the database whenever they are asked for; there are none while it is away."""

    def __init__(self, app: FastAPI) -> None:
        self._app = app

    def collect(self) -> Iterator[GaugeMetricFamily]:
        resources = getattr(self._app.state, "resources", None)
        try:
            figures = queue_figures(resources.database.of(SERVICE)) if resources else {}
        except SQLAlchemyError as error:
            log.warning("queue_not_read", error=str(getattr(error, "orig", error)))
            return
        for name, (about, value) in figures.items():
            yield GaugeMetricFamily(f"treestroke_{name}", about, value)


def add_metrics(app: FastAPI, hosted: bool) -> None:
    """Count requests by route, and serve all metrics at /metrics, unless others than its person reach the service."""
    counting = Instrumentator(excluded_handlers=["/metrics"]).instrument(app)
    if not hosted:
        counting.expose(app, include_in_schema=False)
    REGISTRY.register(_Queue(app))


@contextmanager
def private_metrics(settings: Settings) -> Iterator[None]:
    """Serve all metrics on a port of their own, where there is one, without a key."""
    if not settings.metrics_port:
        yield
        return
    server, thread = start_http_server(settings.metrics_port, addr=settings.host)
    try:
        yield
    finally:
        server.shutdown()
        server.server_close()
        thread.join()

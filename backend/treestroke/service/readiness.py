"""Whether the running service accepts requests."""

import shutil

from sqlalchemy import select
from sqlalchemy.exc import SQLAlchemyError

from treestroke.schemas import Health
from treestroke.service.dispatch import Dispatcher
from treestroke.service.photos import Resources
from treestroke.store.objects import StorageAway
from treestroke.store.tables import Worker

MIN_FREE_BYTES = 500_000_000


def readiness(resources: Resources, dispatcher: Dispatcher) -> Health:
    """Return whether the service accepts requests, by checks that are cheap enough for every second."""
    failure = resources.tracers.failure
    checks = {
        "broker": "ok" if dispatcher.broker_accepts else "does not accept messages; jobs wait",
        "dispatcher": dispatcher.state,
        "tracers": "ok" if failure is None else f"the last start failed ({failure}); the next request tries again",
    }
    try:
        with resources.database.reading() as session:
            workers = session.scalars(select(Worker.id)).all()
        checks["database"] = "ok"
        checks["workers"] = "ok" if workers else "none; jobs wait"
    except SQLAlchemyError:
        checks["database"] = "unavailable"
    free = shutil.disk_usage(resources.blobs.data).free
    checks["storage"] = "ok" if free > MIN_FREE_BYTES else f"only {free // 10**6} MB free"
    try:
        resources.blobs.objects.check_reachable()
    except StorageAway:
        checks["storage"] = "the bucket does not respond"
    down = checks["database"] != "ok"
    ok = all(check in ("ok", "standby") for check in checks.values())
    return Health(status="down" if down else "ok" if ok else "degraded", checks=checks)

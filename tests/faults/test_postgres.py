"""A service on Postgres, which is restarted under it."""

from pathlib import Path

from tests.faults.harness import PATIENCE_SECONDS, POISONED, Service
from tests.faults.processes import wait_for
from tests.hosted import SECRET, Hosted
from tests.postgres import PostgresServer
from tests.promises import kept

from treestroke.store.database import Database


def test_a_model_outlives_a_postgres_that_is_away_while_it_is_finished(
    tmp_path: Path, postgres: PostgresServer
) -> None:
    url = postgres.fresh()
    settings = {"database_url": url, "secret": SECRET, "workers": 1}
    with Service(tmp_path / "service", program=POISONED, **settings) as service:
        database = Database(service.data, url)
        service.client.headers["Authorization"] = f"Bearer {Hosted(service.client, database).key()}"
        database.close()
        id = service.ask("held")
        wait_for(lambda: service.get(id)["status"] == "running", PATIENCE_SECONDS, "a model under way")
        body = service.body()
        postgres.stop()
        try:
            for answer in (service.client.get(f"/v1/models/{id}"), service.client.post("/v1/models", json=body)):
                assert (answer.status_code, answer.json()["code"]) == (503, "database_unavailable")
                assert answer.headers["retry-after"].isdecimal()
            with kept(2.0):
                service.client.get("/v1/models")
            assert service.client.get("/readyz").json()["checks"]["database"] == "unavailable"
            service.release(id)
            wait_for(lambda: service.logged("database_awaited"), PATIENCE_SECONDS, "a tree that waits to be kept")
        finally:
            postgres.start()
        wait_for(lambda: service.get(id)["status"] == "succeeded", PATIENCE_SECONDS, "the finished model")
        assert service.client.get(f"/v1/models/{id}/tree.glb").status_code == 200
        assert service.logged("attempt_lost") == []
        assert service.client.get("/readyz").json()["checks"]["database"] == "ok"
        assert not (service.data / "treestroke.sqlite3").exists()

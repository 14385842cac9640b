import socket
from pathlib import Path

import httpx
import pytest
from tests.hosted import hosting
from tests.postgres import PostgresServer
from tests.running import serving

from treestroke.core.errors import SettingsError
from treestroke.serve import serve
from treestroke.settings import Settings


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


def test_a_service_with_keys_tells_figures_on_a_port_of_their_own_alone(
    tmp_path: Path, postgres: PostgresServer
) -> None:
    port = free_port()
    with hosting(tmp_path / "data", postgres.fresh_with_tables(), metrics_port=port) as hosted:
        for answer in (hosted.client.get("/metrics"), hosted.ask(hosted.key(), "GET", "/metrics")):
            assert (answer.status_code, answer.json()["code"]) == (404, "not_found")
        hosted.client.get("/s/a-token-of-a-link")
        told = httpx.get(f"http:{'//'}127.0.0.1:{port}/metrics", timeout=60).text
    assert "treestroke_models_queued 0.0" in told
    assert "treestroke_models_queue_age_seconds 0.0" in told
    assert 'handler="/s/{token}"' in told
    assert "a-token-of-a-link" not in told


def test_figures_of_the_queue_are_absent_while_the_database_is_away(tmp_path: Path) -> None:
    port = free_port()
    with serving(tmp_path / "data", workers=0, tracers=1, metrics_port=port) as url:
        place = f"http:{'//'}127.0.0.1:{port}/metrics"
        assert "treestroke_models_queued" in httpx.get(place, timeout=60).text
        (tmp_path / "data" / "treestroke.sqlite3").rename(tmp_path / "elsewhere")
        answer = httpx.get(place, timeout=60)
        assert (answer.status_code, "treestroke_models_queued" in answer.text) == (200, False)
        (tmp_path / "elsewhere").rename(tmp_path / "data" / "treestroke.sqlite3")
        assert httpx.get(f"{url}/metrics", timeout=60).status_code == 200


def test_a_port_that_is_taken_is_one_line(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(SettingsError, match=f"TREESTROKE_METRICS_PORT {port}: .*; take another port"):
            serve(Settings(data=tmp_path / "data", port=0, metrics_port=port))

"""What a service without a terminal writes to stderr."""

import json
from pathlib import Path

from tests.running import serving

from treestroke.client import Client

DATA = Path(__file__).parent / "data"


def test_logs_are_json_and_every_line_of_a_job_names_it(tmp_path: Path) -> None:
    with serving(tmp_path / "data") as address, Client(address) as client:
        photo = client.upload(DATA / "elm_house.jpg")
        model = client.wait(client.grow(photo, DATA / "elm_house.strokes.json", {"iterations": 5}), timeout=120)
    lines = [json.loads(line) for line in (tmp_path / "data.log").read_text().splitlines()]
    assert all({"event", "level", "timestamp"} <= line.keys() for line in lines)
    about = [line for line in lines if line["event"].startswith("job_")]
    assert [line["event"] for line in about] == ["job_started", "job_succeeded"]
    assert {(line["job"], line["attempt"]) for line in about} == {(model.id, 1)}
    assert [line for line in lines if line["level"] not in ("info", "warning")] == []

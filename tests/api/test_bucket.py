"""A service whose files are in a bucket: what it sends, what is damaged, and a bucket that is away."""

import hashlib
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.api import drawn
from tests.api.conftest import PATIENCE_SECONDS, Service, running
from tests.bucket import BUCKET, S3Server


class Stored:
    """A service and the server of its bucket."""

    def __init__(self, service: Service, server: S3Server, url: str) -> None:
        self.service, self.server, self._prefix = service, server, url.rpartition("/")[2]

    def objects(self) -> dict[str, int]:
        """Return the sizes of all objects by their SHA-256."""
        listed = self.server.client().list_objects_v2(Bucket=BUCKET, Prefix=f"{self._prefix}/local/")
        return {one["Key"].rpartition("/")[2]: one["Size"] for one in listed.get("Contents", ())}

    def replace(self, name: str, content: bytes) -> None:
        """Change an object in the bucket; copies of it are gone."""
        key = f"{self._prefix}/local/{name[:2]}/{name}"
        self.server.client().put_object(Bucket=BUCKET, Key=key, Body=content)
        self.forget(name)

    def forget(self, name: str = "*") -> None:
        """Remove copies on the machine."""
        for path in (self.service.data / "cache").rglob(name):
            if path.is_file():
                path.unlink()


@pytest.fixture
def stored(mortal_s3: S3Server, tmp_path: Path) -> Iterator[Stored]:
    url = mortal_s3.fresh()
    for service in running(tmp_path, workers=1, bucket_url=url):
        yield Stored(service, mortal_s3, url)


def test_a_tree_is_grown_and_sent_by_way_of_a_bucket_that_may_be_away(stored: Stored) -> None:
    """Takes over 20 s: a service and its bucket start, and the bucket twice."""
    client = stored.service.client
    photo = stored.service.add_photo(drawn.encoded())
    made = stored.service.make(**drawn.request(photo))
    assert made["status"] == "succeeded", made
    place = made["files"]["tree.glb"]
    whole = client.get(place)
    name = hashlib.sha256(whole.content).hexdigest()
    assert stored.objects()[name] == len(whole.content)
    assert [path for path in (stored.service.data / "blobs").rglob("*") if path.is_file()] == []
    for _ in range(2):  # of a copy, and of one that is fetched for it
        part = client.get(place, headers={"Range": "bytes=100-199"})
        assert (part.status_code, part.content) == (206, whole.content[100:200])
        stored.forget()
    assert client.get(made["files"]["project"]).status_code == 200

    stored.replace(name, whole.content[:-1] + b"!")
    for headers in ({}, {"Range": "bytes=0-9"}):
        assert client.get(place, headers=headers).json()["code"] == "file_damaged"
    stored.replace(name, whole.content)

    before = stored.objects()
    stored.server.kill()
    stored.forget()
    refused = [client.get(place), client.post("/v1/photos", files={"file": drawn.encoded(seed=9)})]
    assert [answer.json()["code"] for answer in refused] == ["storage_unavailable"] * 2
    assert [(answer.status_code, answer.headers["retry-after"]) for answer in refused] == [(503, "1")] * 2
    assert client.get("/readyz").json()["checks"]["storage"] == "the bucket does not respond"
    stored.server.start()
    assert stored.objects() == before
    left = [path for path in (stored.service.data / "tmp").iterdir() if not path.name.startswith("pymp-")]
    assert left == []  # but for Python's own folder for sockets
    assert client.get(place).content == whole.content
    assert client.get("/readyz").json()["checks"]["storage"] == "ok"


def test_a_job_waits_for_its_bucket_and_publishes_afterwards(stored: Stored) -> None:
    """Takes over 20 s: a service and its bucket start, and the bucket twice."""
    client = stored.service.client
    photo = stored.service.add_photo(drawn.encoded())
    asked = client.post("/v1/models", json=drawn.request(photo)).json()
    stored.server.kill()
    stored.forget()
    deadline = time.monotonic() + PATIENCE_SECONDS
    while client.get(f"/v1/models/{asked['id']}").json()["status"] == "queued":
        assert time.monotonic() < deadline
        time.sleep(0.1)
    stored.server.start()
    made = stored.service.finished(client.get(f"/v1/models/{asked['id']}"))
    assert made["status"] == "succeeded", made
    assert client.get(made["files"]["tree.glb"]).status_code == 200

"""Objects in a bucket of S3 or of a server that speaks as it does, with copies on this machine of those in use.

Each is sent with its SHA-256, which the server compares, and each copy is compared with its name when it arrives.
"""

import base64
import hashlib
import re
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, TypeVar

from treestroke.store.copies import Copies
from treestroke.store.objects import Damaged, StorageAway, write_verified

T = TypeVar("T")

_KEY = re.compile(r"([\w-]{1,40})/([0-9a-f]{2})/(\2[0-9a-f]{62})")
"""A team, and the name of an object, in its key; whatever else is in the bucket is nothing of ours."""
_PIECE = 2**20
"""Bytes that are in memory at once."""
_PAUSE_SECONDS = 1.0
"""Pause before the bucket is asked again."""
_LOCKS = 32
_TIMES = {"connect_timeout": 2, "read_timeout": 10, "retries": {"total_max_attempts": 2, "mode": "standard"}}
_BRIEF_TIMES = {"connect_timeout": 1, "read_timeout": 4, "retries": {"total_max_attempts": 1}}
"""The same where somebody waits: for whether the bucket responds, or for rows that are locked."""


class _Missing(Exception):
    """There is no such object."""


class BucketObjects:
    """Objects in a bucket: ``PREFIX/TEAM/ab/SHA-256``.

    Parameters
    ----------
    url
        s3://BUCKET/PREFIX; address, region and credentials of the server are those of the usual AWS_... variables.
    copies
        The copies on this machine.
    patience_s
        How long an answer is asked for again while the bucket is away.
    """

    def __init__(self, url: str, copies: Copies, patience_s: float = 0.0) -> None:
        self.place = url
        self._bucket, _, prefix = url.removeprefix("s3://").strip("/").partition("/")
        self._prefix = f"{prefix}/" if prefix else ""
        self._copies, self._patience_s = copies, patience_s
        self._client, self._brief = _clients(_TIMES, _BRIEF_TIMES)
        self._locks = [threading.Lock() for _ in range(_LOCKS)]

    def put(self, team: str, name: str, content: bytes) -> None:
        """Store an object; as `store.objects.Objects.put`."""
        self._asked(lambda: self._send(team, name, content))

    def take(self, team: str, name: str, path: Path) -> None:
        """Store a file, which then becomes the copy on this machine; as `store.objects.Objects.take`."""

        def send() -> None:
            with path.open("rb") as file:
                self._send(team, name, file)

        self._asked(send)
        self._copies.take(team, name, path)

    def local(self, team: str, name: str, again: bool = False) -> Path:
        """Return the path of a copy, fetched if missing, or ``again``; as `store.objects.Objects.local`."""
        with self._locks[int(name[:2], 16) % _LOCKS]:
            path = None if again else self._copies.find(team, name)
            if path is not None:
                return path
            try:
                return self._asked(lambda: self._fetch(team, name))
            except _Missing:
                raise Damaged(f"{name}: missing") from None

    def copy(self, team: str, name: str, path: Path) -> None:
        """Copy an object, not its copy on this machine; as `store.objects.Objects.copy`."""
        try:
            self._asked(lambda: write_verified(path, name, self._pieces(self._get(team, name))))
        except _Missing:
            raise Damaged(f"{name}: missing") from None

    def verify(self, team: str, name: str) -> None:
        """Compare an object, not its copy, with its name; as `store.objects.Objects.verify`."""

        def read() -> str:
            found = hashlib.sha256()
            for piece in self._pieces(self._get(team, name)):
                found.update(piece)
            return found.hexdigest()

        try:
            if self._asked(read) != name:
                raise Damaged(f"{name}: damaged")
        except _Missing:
            raise Damaged(f"{name}: missing") from None

    def remove(self, team: str, names: Sequence[str]) -> None:
        """Remove objects and their copies here, without patience: rows are locked meanwhile."""
        objects = [{"Key": self._key(team, name)} for name in names if re.fullmatch("[0-9a-f]{64}", name)]
        if objects:
            asked = {"Bucket": self._bucket, "Delete": {"Objects": objects, "Quiet": True}}
            answer = self._once(lambda: self._brief.delete_objects(**asked))
            if answer.get("Errors"):
                raise StorageAway(f"{self.place}: {answer['Errors'][0].get('Message')}")
        for name in names:
            self._copies.remove(team, name)

    def pages(self) -> Iterator[tuple[str, dict[str, int]]]:
        """Yield all objects, at most a thousand at a time; as `store.objects.Objects.pages`."""
        asked = {"Bucket": self._bucket, "Prefix": self._prefix}
        while True:
            answer = self._once(lambda: self._client.list_objects_v2(**asked))
            yield from self._by_team(answer.get("Contents", ()))
            if not answer.get("IsTruncated"):
                return
            asked["ContinuationToken"] = answer["NextContinuationToken"]

    def check_reachable(self) -> None:
        """Ask for the bucket; as `store.objects.Objects.check_reachable`."""
        self._once(lambda: self._brief.head_bucket(Bucket=self._bucket))

    def _key(self, team: str, name: str) -> str:
        return f"{self._prefix}{team}/{name[:2]}/{name}"

    def _by_team(self, contents: Sequence[dict[str, Any]]) -> Iterator[tuple[str, dict[str, int]]]:
        teams: dict[str, dict[str, int]] = {}
        for one in contents:
            if found := _KEY.fullmatch(one["Key"].removeprefix(self._prefix)):
                teams.setdefault(found[1], {})[found[3]] = one["Size"]
        yield from teams.items()

    def _send(self, team: str, name: str, content: Any) -> None:
        digest = base64.b64encode(bytes.fromhex(name)).decode()
        self._client.put_object(Bucket=self._bucket, Key=self._key(team, name), Body=content, ChecksumSHA256=digest)

    def _get(self, team: str, name: str) -> Any:
        return self._client.get_object(Bucket=self._bucket, Key=self._key(team, name))

    def _fetch(self, team: str, name: str) -> Path:
        answer = self._get(team, name)
        return self._copies.write(team, name, answer["ContentLength"], self._pieces(answer))

    def _pieces(self, answer: Any) -> Iterator[bytes]:
        with closing(answer["Body"]) as body:
            yield from body.iter_chunks(_PIECE)

    def _asked(self, ask: Callable[[], T]) -> T:
        """Return what the bucket answers; while it is away it is asked again for as long as patience lasts."""
        deadline = time.monotonic() + self._patience_s
        while True:
            try:
                return self._once(ask)
            except StorageAway:
                if time.monotonic() >= deadline:
                    raise
                time.sleep(_PAUSE_SECONDS)

    def _once(self, ask: Callable[[], T]) -> T:
        from botocore.exceptions import BotoCoreError, ClientError

        try:
            return ask()
        except ClientError as error:
            if error.response.get("Error", {}).get("Code") == "NoSuchKey":
                raise _Missing from error
            raise StorageAway(f"{self.place}: {error}") from error
        except BotoCoreError as error:
            raise StorageAway(f"{self.place}: {error}") from error


def _clients(*times: dict[str, Any]) -> list[Any]:
    """Return clients of the server; boto3, which takes long to import, is imported only where there is a bucket."""
    import boto3
    from botocore.config import Config

    # Contents are compared by SHA-256: further checksums would only cost time.
    checksums = {"request_checksum_calculation": "when_required", "response_checksum_validation": "when_required"}
    configs = (Config(max_pool_connections=_LOCKS, **checksums, **one) for one in times)
    session = boto3.session.Session()
    return [session.client("s3", config=config) for config in configs]

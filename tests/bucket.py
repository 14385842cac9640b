"""An S3 server of the tests' own (SeaweedFS, from a package): it can be killed and started again."""

import json
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, suppress
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from tests.faults.processes import wait_for

BUCKET = "forest"
KEY, SECRET = "tests", "not-a-secret-of-anyone"
START_SECONDS = 120
"""Emergency exit of waiting for the server, which starts slowly where the machine is busy."""
_PARTS = ("master", "volume", "filer", "s3")
_NUMBERS = count(1)
_TESTS = {"name": "tests", "credentials": [{"accessKey": KEY, "secretKey": SECRET}], "actions": ["Admin"]}


class S3Server:
    """SeaweedFS on ports and in a folder of its own, with one pair of credentials, and perhaps more identities."""

    def __init__(self, folder: Path, more: Sequence[object] = ()) -> None:
        self._folder, self._ports = folder, _free_ports(2 * len(_PARTS))
        folder.mkdir(exist_ok=True)
        (folder / "may.json").write_text(json.dumps({"identities": [_TESTS, *more]}))
        self._process: subprocess.Popen[bytes] | None = None
        self.start()

    @property
    def environment(self) -> dict[str, str]:
        """The variables by which programs reach it."""
        at = f"http:{'//'}127.0.0.1:{self._ports[-2]}"
        names = {"AWS_ACCESS_KEY_ID": KEY, "AWS_SECRET_ACCESS_KEY": SECRET, "AWS_DEFAULT_REGION": "us-east-1"}
        return {**names, "AWS_ENDPOINT_URL_S3": at, "NO_PROXY": "127.0.0.1"}

    def start(self) -> None:
        """Start it and wait until it answers."""
        self.launch()
        wait_for(self._answers, START_SECONDS, "an answer from the S3 server")

    def launch(self) -> None:
        """Start it; it answers a while later."""
        own = [f"-{part}.port={port}" for part, port in zip(_PARTS, self._ports[::2], strict=True)]
        own += [f"-{part}.port.grpc={port}" for part, port in zip(_PARTS, self._ports[1::2], strict=True)]
        own += [
            f"-dir={self._folder}",
            f"-s3.config={self._folder / 'may.json'}",
            "-ip=127.0.0.1",
            "-ip.bind=127.0.0.1",
        ]
        own += ["-filer", "-s3", "-master.volumeSizeLimitMB=64", "-volume.max=30", "-master.telemetry=false"]
        own += ["-s3.port.iceberg=0", "-s3.port.lance=0"]
        program = [str(Path(sys.executable).with_name("weed")), "server"]
        self._process = subprocess.Popen(
            [*program, *own], cwd=self._folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )

    def kill(self) -> None:
        """Kill it, as a power cut does; what it has stored is there when it starts again."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None

    def freeze(self) -> None:
        """Stop it where it stands."""
        assert self._process is not None
        self._process.send_signal(signal.SIGSTOP)

    def thaw(self) -> None:
        """Let it go on."""
        assert self._process is not None
        self._process.send_signal(signal.SIGCONT)

    def client(self) -> Any:
        """Return a client with the credentials."""
        import boto3  # here, because most tests need none and it takes long

        session = boto3.session.Session(KEY, SECRET, region_name="us-east-1")
        return session.client("s3", endpoint_url=self.environment["AWS_ENDPOINT_URL_S3"])

    def fresh(self) -> str:
        """Return the URL of an empty place in the one bucket: each bucket takes volumes of its own."""
        return f"s3:{'//'}{BUCKET}/trees-{next(_NUMBERS)}"

    def _answers(self) -> bool:
        """Tell whether it takes a file, which it does some time after its port is open."""
        from botocore.exceptions import BotoCoreError, ClientError

        with suppress(BotoCoreError, ClientError):
            if BUCKET not in {bucket["Name"] for bucket in self.client().list_buckets()["Buckets"]}:
                self.client().create_bucket(Bucket=BUCKET)
            self.client().put_object(Bucket=BUCKET, Key="one", Body=b"one")
            return True
        return False


def _free_ports(count: int) -> list[int]:
    with ExitStack() as opened:
        sockets = [opened.enter_context(socket.create_server(("127.0.0.1", 0))) for _ in range(count)]
        return [one.getsockname()[1] for one in sockets]


@pytest.fixture(scope="session")
def s3_server() -> Iterator[S3Server]:
    with tempfile.TemporaryDirectory(prefix="treestroke-s3-") as folder:
        server = S3Server(Path(folder))
        yield server
        server.kill()


@pytest.fixture
def mortal_s3(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[S3Server]:
    """A server that a test may kill; programs that this one starts reach it."""
    server = S3Server(tmp_path / "s3")
    for name, value in server.environment.items():
        monkeypatch.setenv(name, value)
    yield server
    server.kill()


@pytest.fixture
def bucket_url(s3_server: S3Server, monkeypatch: pytest.MonkeyPatch) -> str:
    """The URL of an empty place in a bucket, which programs that this one starts reach, too."""
    for name, value in s3_server.environment.items():
        monkeypatch.setenv(name, value)
    return s3_server.fresh()

"""What is a bucket's own: checksums, copies on this machine, a server that is away and comes back."""

import base64
import hashlib
import threading
from pathlib import Path

import boto3
import pytest
from botocore.exceptions import ClientError
from tests.bucket import BUCKET, S3Server

from treestroke.store.bucket import BucketObjects
from treestroke.store.copies import Copies
from treestroke.store.objects import Damaged, StorageAway

TREE = hashlib.sha256(b"tree").hexdigest()


@pytest.fixture
def objects(bucket_url: str, tmp_path: Path) -> BucketObjects:
    return BucketObjects(bucket_url, Copies(tmp_path))


def test_the_server_refuses_what_has_another_sha256(objects: BucketObjects) -> None:
    digest = base64.b64encode(bytes.fromhex(TREE)).decode()
    with pytest.raises(ClientError, match="BadDigest"):
        boto3.client("s3").put_object(Bucket=BUCKET, Key="x", Body=b"trie", ChecksumSHA256=digest)
    with pytest.raises(StorageAway, match="BadDigest"):
        objects.put("local", TREE, b"trie")
    assert list(objects.pages()) == []


def test_nothing_else_in_the_bucket_is_ours(objects: BucketObjects, bucket_url: str) -> None:
    prefix, name = bucket_url.rpartition("/")[2], f"{TREE[:2]}/{TREE}"
    for key in (f"local/{name}", f"{prefix}/local/{TREE}", f"{prefix}/notes.txt", f"{prefix}/a/b/{name}"):
        boto3.client("s3").put_object(Bucket=BUCKET, Key=key, Body=b"theirs")
    assert list(objects.pages()) == []
    objects.put("team_oaks", TREE, b"tree")
    assert list(objects.pages()) == [("team_oaks", {TREE: 4})]


def test_objects_are_listed_page_by_page(objects: BucketObjects, monkeypatch: pytest.MonkeyPatch) -> None:
    names = {hashlib.sha256(b"%d" % at).hexdigest() for at in range(25)}
    for at in range(25):
        objects.put("local", hashlib.sha256(b"%d" % at).hexdigest(), b"%d" % at)
    listed = objects._client.list_objects_v2
    monkeypatch.setattr(objects._client, "list_objects_v2", lambda **asked: listed(**asked, MaxKeys=10))
    pages = list(objects.pages())
    assert [len(sizes) for _, sizes in pages] == [10, 10, 5]
    assert {name for _, sizes in pages for name in sizes} == names
    objects.remove("local", [*names, TREE])
    assert list(objects.pages()) == []


def test_a_copy_is_fetched_once_and_again_where_it_is_damaged(objects: BucketObjects, tmp_path: Path) -> None:
    objects.put("local", TREE, b"tree")
    path = objects.local("local", TREE)
    assert path == tmp_path / "cache" / "local" / TREE[:2] / TREE
    path.write_bytes(b"trie")
    assert objects.local("local", TREE).read_bytes() == b"trie"
    assert objects.local("local", TREE, again=True).read_bytes() == b"tree"
    objects.remove("local", [TREE])
    assert not path.exists()


def test_what_arrives_damaged_leaves_nothing(objects: BucketObjects, bucket_url: str, tmp_path: Path) -> None:
    key = f"{bucket_url.rpartition('/')[2]}/local/{TREE[:2]}/{TREE}"
    boto3.client("s3").put_object(Bucket=BUCKET, Key=key, Body=b"trie")
    with pytest.raises(Damaged):
        objects.local("local", TREE)
    assert [path for path in (tmp_path / "cache").rglob("*") if path.is_file()] == []


def test_a_bucket_that_is_away_says_so_and_has_lost_nothing(mortal_s3: S3Server, tmp_path: Path) -> None:
    """Takes over 20 s: the server starts twice."""
    url = mortal_s3.fresh()
    hasty = BucketObjects(url, Copies(tmp_path))
    hasty.put("local", TREE, b"tree")
    hasty.check_reachable()
    mortal_s3.kill()
    asks = [
        hasty.check_reachable,
        lambda: hasty.put("local", TREE, b"tree"),
        lambda: hasty.local("local", TREE),
        lambda: hasty.verify("local", TREE),
        lambda: hasty.remove("local", [TREE]),
        lambda: list(hasty.pages()),
    ]
    for ask in asks:
        with pytest.raises(StorageAway):
            ask()
    patient = BucketObjects(url, Copies(tmp_path / "other"), patience_s=600)
    waiting = threading.Thread(target=patient.put, args=("local", hashlib.sha256(b"late").hexdigest(), b"late"))
    waiting.start()
    mortal_s3.start()
    waiting.join()
    assert patient.local("local", TREE).read_bytes() == b"tree"
    assert patient.local("local", hashlib.sha256(b"late").hexdigest()).read_bytes() == b"late"


def test_a_bucket_that_is_not_there_or_not_ours_is_away(
    objects: BucketObjects, bucket_url: str, tmp_path: Path
) -> None:
    missing = BucketObjects(bucket_url.replace(BUCKET, "no-forest"), Copies(tmp_path))
    with pytest.raises(StorageAway):
        missing.check_reachable()
    with pytest.raises(StorageAway):
        list(missing.pages())

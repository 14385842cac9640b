import hashlib
from dataclasses import replace

import pytest
from tests.api import drawn

from treestroke.core.errors import PhotoError
from treestroke.service import photos
from treestroke.service.photos import NotFound, Resources
from treestroke.service.tracer import NoRoom
from treestroke.store.queries import stored_bytes
from treestroke.store.tables import PhotoRow


def count(resources: Resources, table: type[PhotoRow]) -> int:
    with resources.database.reading() as session:
        return session.query(table).count()


def test_a_photo_is_kept_once_it_is_decoded(resources: Resources) -> None:
    row = photos.add_photo(resources, drawn.encoded("JPEG"))
    assert photos.get_photo(resources, row.id).blob == row.blob
    assert resources.blobs.get(row.blob).startswith(b"\x89PNG")


def test_a_photo_that_cannot_be_used_leaves_nothing(resources: Resources) -> None:
    with pytest.raises(PhotoError):
        photos.add_photo(resources, b"no photo")
    assert count(resources, PhotoRow) == 0
    assert not (resources.blobs.data / "blobs").exists()


def test_the_same_photo_twice_is_two_photos_and_one_file(resources: Resources) -> None:
    first, second = (photos.add_photo(resources, drawn.encoded()) for _ in range(2))
    assert first.id != second.id
    assert first.blob == second.blob
    assert first.sha256 == second.sha256 == hashlib.sha256(drawn.encoded()).hexdigest()
    photos.delete_photo(resources, first.id)
    assert photos.get_photo(resources, second.id)
    with pytest.raises(NotFound):
        photos.delete_photo(resources, first.id)
    with pytest.raises(NotFound):
        photos.trace_photo(resources, first.id, b"{}")


def kept(resources: Resources) -> int:
    with resources.database.reading() as session:
        return stored_bytes(session)


def test_a_photo_counts_by_what_it_takes_as_it_is_kept(resources: Resources) -> None:
    assert kept(resources) == 0
    first, other = (photos.add_photo(resources, drawn.encoded(seed=seed)) for seed in (0, 1))
    photos.add_photo(resources, drawn.encoded())  # the pixels of the first, which are kept once
    assert kept(resources) == first.bytes + other.bytes
    assert first.bytes == resources.blobs.path(first.blob).stat().st_size


def test_a_deleted_photo_counts_until_it_is_removed_for_good(resources: Resources) -> None:
    row = photos.add_photo(resources, drawn.encoded())
    full = replace(resources, photos_bytes=row.bytes)
    photos.delete_photo(resources, row.id)
    with pytest.raises(NoRoom):
        photos.add_photo(full, drawn.encoded(seed=1))
    with resources.database.writing() as session:
        session.query(PhotoRow).delete()  # as the sweep does a day later
    assert photos.add_photo(full, drawn.encoded())


def test_no_photo_is_taken_beyond_what_all_may_take(resources: Resources) -> None:
    row = photos.add_photo(resources, drawn.encoded())
    tight = replace(resources, photos_bytes=row.bytes + 1000)
    for take in (photos.add_photo, photos.store_pixels):
        with pytest.raises(NoRoom):
            take(tight, drawn.encoded(seed=1))
    assert count(resources, PhotoRow) == 1
    assert sum(path.is_file() for path in (resources.blobs.data / "blobs").rglob("*")) == 1

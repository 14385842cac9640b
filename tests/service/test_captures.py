from collections.abc import Sequence
from typing import Any

import pytest
from tests.api import drawn
from tests.plans import planned, scans
from tests.rows import add_capture, add_solve, claim
from tests.structures import small_structure

from treestroke.codec.structure import encode_structure
from treestroke.core.errors import CaptureError, PhotoError, TreestrokeError
from treestroke.limits import MAX_NAME, MAX_PHOTOS
from treestroke.service import captures
from treestroke.service.captures import StoredCapture
from treestroke.service.photos import NotFound, Resources
from treestroke.store.blobs import Damaged
from treestroke.store.leases import complete
from treestroke.store.queries import referenced, stored_bytes
from treestroke.store.tables import SolveRow


def made(resources: Resources, seeds: Sequence[int] = (), name: str = "") -> str:
    """Make a capture of drawn photos, 0.png and so on; give its id."""
    id = captures.make_capture(resources.database, f'{{"name": "{name}"}}'.encode()).id
    for seed in seeds:
        add(resources, id, f"{seed}.png", seed)
    return id


def of_five(resources: Resources, **values: Any) -> str:
    """Write a capture with rows of five photos that nobody decodes; give its id."""
    return add_capture(resources.database, [f"{number}" * 64 for number in range(5)], **values).id


def add(resources: Resources, id: str, name: str, seed: int = 0) -> tuple[str, bool]:
    photo, added = captures.add_photo(resources, id, name, drawn.encoded(seed=seed))
    return photo.name, added


def found(resources: Resources, id: str) -> StoredCapture:
    return captures.find_capture(resources.database, id)


def work(resources: Resources, id: str) -> SolveRow:
    """Begin to solve a capture as a worker does."""
    capture = found(resources, id)
    assert capture.solve is not None
    return claim(resources.database, capture.solve)


def solved(resources: Resources, id: str) -> str:
    """Solve a capture as its worker does; give the structure's blob."""
    assert captures.solve(resources, id).status == "queued"
    job, names = work(resources, id), [photo.name for photo in found(resources, id).photos]
    blob = resources.blobs.put(encode_structure(small_structure(names[1:], names[:1])))
    with resources.database.writing() as session:
        assert complete(session, job, structure=blob)
    return blob


def test_a_capture_begins_empty_with_the_name_that_it_is_given(resources: Resources) -> None:
    capture = found(resources, made(resources, name="The old oak"))
    assert (capture.row.name, capture.photos, capture.status) == ("The old oak", [], "unsolved")
    assert captures.make_capture(resources.database, b"").row.name == ""


@pytest.mark.parametrize("body", [b"[]", b'{"name": 1}', b'{"photos": []}', b"{", b'{"name": "a\\nb"}'])
def test_what_is_no_request_for_a_capture_is_refused(resources: Resources, body: bytes) -> None:
    with pytest.raises(TreestrokeError):
        captures.make_capture(resources.database, body)


def test_photos_come_in_any_order_and_stand_by_name(resources: Resources) -> None:
    id = made(resources, [2, 0, 1])
    assert [photo.name for photo in found(resources, id).photos] == ["0.png", "1.png", "2.png"]


def test_the_same_bytes_by_the_same_name_are_one_photo(resources: Resources) -> None:
    id = made(resources, [0])
    before = found(resources, id)
    assert add(resources, id, "0.png", 0) == ("0.png", False)
    assert found(resources, id).version == before.version
    assert add(resources, id, "copy.png", 0) == ("copy.png", True)
    assert len(found(resources, id).photos) == 2


def test_another_photo_of_the_same_name_gets_a_number_and_may_be_sent_again_too(resources: Resources) -> None:
    id = made(resources, [0])
    assert add(resources, id, "0.png", 1) == ("0 (2).png", True)
    assert add(resources, id, "elsewhere/0.png", 2) == ("0 (3).png", True)
    assert add(resources, id, "0.png", 1) == ("0 (2).png", False)


@pytest.mark.parametrize(
    ("sent", "kept"),
    [
        ("../../etc/a.jpg", "a.jpg"),
        ("photos\\a.jpg", "a.jpg"),
        ("a\r\nX: 1.jpg", "a__X: 1.jpg"),
        ("\u202egpj.exe", "_gpj.exe"),
        ("\ud800.jpg", "?.jpg"),
        ("🌳.jpg", "🌳.jpg"),
        (f"{'n' * 500}.jpg", f"{'n' * (MAX_NAME - 4)}.jpg"),
    ],
)
def test_a_photo_s_name_is_one_line_and_no_path(resources: Resources, sent: str, kept: str) -> None:
    assert add(resources, made(resources), sent) == (kept, True)


@pytest.mark.parametrize("sent", ["", "..", "/", "a/.."])
def test_a_photo_without_a_name_is_called_by_its_bytes(resources: Resources, sent: str) -> None:
    id = made(resources)
    name, _ = add(resources, id, sent)
    assert found(resources, id).photos[0].sha256.startswith(name)
    assert len(name) == 12


def test_a_photo_that_cannot_be_used_changes_nothing(resources: Resources) -> None:
    id = made(resources, [0])
    before = found(resources, id).version
    with pytest.raises(PhotoError):
        captures.add_photo(resources, id, "broken.png", drawn.encoded()[:-500])
    assert found(resources, id).version == before
    assert len(found(resources, id).photos) == 1


def test_a_capture_has_only_so_many_photos_and_knows_all_of_them(resources: Resources) -> None:
    id = add_capture(resources.database, [f"{number:064}" for number in range(MAX_PHOTOS - 1)]).id
    add(resources, id, "last.png")
    with pytest.raises(CaptureError, match="there are 60, at most 60 are allowed; remove some") as refused:
        add(resources, id, "one more.png", 1)
    assert refused.value.code == "capture_full"
    assert add(resources, id, "last.png") == ("last.png", False)


def test_too_few_photos_are_not_solved(resources: Resources) -> None:
    with pytest.raises(CaptureError, match="there are 1, at least 5 are needed; take more") as refused:
        captures.solve(resources, made(resources, [0]))
    assert refused.value.code == "too_few_photos"


def test_a_solve_under_way_is_the_answer_to_another_request(resources: Resources) -> None:
    id = of_five(resources)
    first = captures.solve(resources, id)
    assert (first.status, first.queue_position) == ("queued", 1)
    work(resources, id)
    again = captures.solve(resources, id)
    assert again.status == "running"
    assert again.solve is not None
    assert first.solve is not None
    assert again.solve.id == first.solve.id


def test_what_was_found_belongs_to_just_these_photos(resources: Resources) -> None:
    id = of_five(resources)
    solved(resources, id)
    capture = found(resources, id)
    assert capture.status == "solved"
    structure = captures.structure_of(resources.blobs, capture)
    assert structure is not None
    assert [photo.name for photo in structure.photos] == [photo.name for photo in capture.photos[1:]]
    assert add(resources, id, "another.png") == ("another.png", True)
    more = found(resources, id)
    assert (more.status, captures.structure_of(resources.blobs, more)) == ("unsolved", None)
    (another,) = [photo for photo in more.photos if photo.name == "another.png"]
    captures.remove_photo(resources.database, id, another.id)
    assert found(resources, id).status == "solved"  # these are the photos that were solved


def test_the_same_photos_are_not_solved_again(resources: Resources) -> None:
    first, second = of_five(resources), of_five(resources)
    blob = solved(resources, first)
    for id in (first, second):
        answer = captures.solve(resources, id)
        assert answer.status == "solved"
        assert answer.solve is not None
        assert answer.solve.structure == blob
    assert len({found(resources, id).solve.id for id in (first, second)}) == 2  # type: ignore[union-attr]


def test_a_structure_of_another_engine_is_kept_and_found_anew_on_request(resources: Resources) -> None:
    id = of_five(resources)
    solved(resources, id)
    capture = found(resources, id)
    with resources.database.writing() as session:
        session.merge(capture.solve).engine = "an older one"
    assert found(resources, id).status == "solved"
    assert captures.solve(resources, id).status == "queued"


def test_a_damaged_structure_is_found_anew(resources: Resources) -> None:
    id = of_five(resources)
    resources.blobs.path(solved(resources, id)).write_bytes(b"{}")
    with pytest.raises(Damaged):
        captures.structure_of(resources.blobs, found(resources, id))
    assert captures.solve(resources, id).status == "queued"


def test_other_photos_stop_the_solve_of_the_ones_before(resources: Resources) -> None:
    queued, running = of_five(resources), of_five(resources)
    captures.solve(resources, running)
    job = work(resources, running)
    captures.solve(resources, queued)
    for id in (queued, running):
        photo = found(resources, id).photos[0]
        captures.remove_photo(resources.database, id, photo.id)
        assert found(resources, id).status == "unsolved"
    with resources.database.reading() as session:
        now = session.get(SolveRow, job.number)
        assert now is not None
        assert (now.status, now.cancel) == ("running", True)


def test_a_canceled_solve_leaves_the_capture_unsolved_and_may_be_asked_for_again(resources: Resources) -> None:
    id = of_five(resources)
    captures.solve(resources, id)
    assert captures.cancel(resources.database, id).status == "unsolved"
    captures.solve(resources, id)
    work(resources, id)
    assert captures.cancel(resources.database, id).status == "running"  # until its worker has heard
    assert captures.solve(resources, id).status == "queued"


def test_a_solved_capture_is_not_canceled(resources: Resources) -> None:
    id = of_five(resources)
    solved(resources, id)
    assert captures.cancel(resources.database, id).status == "solved"


def test_a_deleted_capture_is_gone_and_stops(resources: Resources) -> None:
    id = of_five(resources)
    captures.solve(resources, id)
    captures.delete(resources.database, id)
    for call in (captures.find_capture, captures.delete, captures.cancel):
        with pytest.raises(NotFound, match="capture"):
            call(resources.database, id)
    with pytest.raises(NotFound, match="capture"):
        add(resources, id, "a.png")
    assert captures.find_capture(resources.database, id, deleted=True).status == "unsolved"


def test_a_photo_is_found_in_its_own_capture_alone(resources: Resources) -> None:
    one, other = of_five(resources), of_five(resources)
    photo = found(resources, one).photos[0].id
    assert captures.find_photo(resources.database, one, photo).id == photo
    for call in (captures.find_photo, captures.remove_photo):
        with pytest.raises(NotFound, match="photo"):
            call(resources.database, other, photo)


def test_captures_are_listed_newest_first_without_the_deleted(resources: Resources) -> None:
    ids = [of_five(resources) for _ in range(4)]
    captures.delete(resources.database, ids[1])
    page, cursor = captures.list_captures(resources.database, None, 2)
    assert [capture.id for capture in page] == [ids[3], ids[2]]
    rest, last = captures.list_captures(resources.database, cursor, 2)
    assert ([capture.id for capture in rest], last) == ([ids[0]], None)


def test_only_what_has_changed_is_told(resources: Resources) -> None:
    ids = [of_five(resources) for _ in range(2)]
    versions: dict[str, object] = {id: found(resources, id).version for id in ids}
    assert captures.find_changed(resources.database, versions) == {}
    captures.solve(resources, ids[0])
    changed = captures.find_changed(resources.database, {**versions, "cap_gone": None})
    assert {id: capture and capture.status for id, capture in changed.items()} == {ids[0]: "queued", "cap_gone": None}


def test_what_photos_of_captures_take_counts_with_all_others(resources: Resources) -> None:
    id = made(resources, [0])
    kept = found(resources, id).photos[0]
    with resources.database.reading() as session:
        assert stored_bytes(session) == kept.bytes == resources.blobs.path(kept.blob).stat().st_size
        assert kept.blob in referenced(session, kept.blob[:2])


def test_no_question_reads_a_whole_table(resources: Resources) -> None:
    id = of_five(resources)
    add_solve(resources.database, id)
    photo = found(resources, id).photos[0].id
    with planned() as steps:
        captures.solve(resources, id)
        found(resources, id)
        captures.list_captures(resources.database, "10", 20)
        captures.find_changed(resources.database, {id: None})
        captures.find_photo(resources.database, id, photo)
        captures.remove_photo(resources.database, id, photo)
    assert len(steps) > 10
    assert scans(steps) == []

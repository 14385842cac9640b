from tests.rows import add_model

from treestroke.store import queries
from treestroke.store.database import Database
from treestroke.store.tables import Photo


def test_ids_say_their_kind_and_cannot_be_guessed() -> None:
    ids = {queries.new_id("mdl") for _ in range(1000)}
    assert len(ids) == 1000
    assert all(id.startswith("mdl_") and len(id) == 28 for id in ids)


def test_a_deleted_row_is_found_only_where_it_is_asked_for(database: Database) -> None:
    model = add_model(database, deleted=1.0)
    photo = Photo(id="pho_1", sha256="", width=1, height=1, blob="", created=0.0, deleted=1.0)
    with database.writing() as session:
        session.add(photo)
    with database.reading() as session:
        assert queries.model(session, model.id) is None
        assert queries.photo(session, "pho_1") is None
        assert queries.model(session, model.id, deleted=True) is not None
        assert queries.photo(session, "pho_1", deleted=True) is not None


def test_places_in_the_queue_count_from_the_next_one(database: Database) -> None:
    add_model(database, status="running")
    queued = [add_model(database) for _ in range(3)]
    with database.reading() as session:
        assert queries.queue_positions(session, [queued[2].number, queued[1].number]) == {
            queued[1].number: 2,
            queued[2].number: 3,
        }
        assert queries.queue_positions(session, []) == {}


def test_the_usual_time_is_the_median_of_late_and_a_guess_before(database: Database) -> None:
    with database.reading() as session:
        assert queries.usual_seconds(session) > 0
    for seconds in (2.0, 3.0, 100.0):
        add_model(database, status="succeeded", started=50.0, finished=50.0 + seconds)
    add_model(database, status="succeeded", finished=5.0)  # answered from another one
    with database.reading() as session:
        assert queries.usual_seconds(session) == 3.0


def test_only_a_finished_model_answers_for_another(database: Database) -> None:
    for status in ("queued", "running", "failed", "canceled"):
        add_model(database, status=status, fingerprint="same")
    with database.reading() as session:
        assert queries.twin(session, "same") is None
    made = add_model(database, status="succeeded", fingerprint="same")
    with database.reading() as session:
        found = queries.twin(session, "same")
    assert found is not None
    assert found.id == made.id

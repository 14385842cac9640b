from tests.plans import planned, scans
from tests.postgres import SQLITE_ONLY
from tests.rows import add_model

from treestroke.store import queries
from treestroke.store.database import Database
from treestroke.store.tables import File, ModelRow, PhotoRow
from treestroke.store.turns import note_turn, wait_for_turn


def test_ids_say_their_kind_and_cannot_be_guessed() -> None:
    ids = {queries.new_id("mdl") for _ in range(1000)}
    assert len(ids) == 1000
    assert all(id.startswith("mdl_") and len(id) == 28 for id in ids)


def test_a_deleted_row_is_found_only_where_it_is_asked_for(database: Database) -> None:
    model = add_model(database, deleted=1.0)
    photo = PhotoRow(id="pho_1", sha256="", width=1, height=1, blob="", created=0.0, deleted=1.0)
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
        assert queries.queue_positions(session, ModelRow, [queued[2].number, queued[1].number]) == {
            queued[1].number: 2,
            queued[2].number: 3,
        }
        assert queries.queue_positions(session, ModelRow, []) == {}


def test_people_of_a_team_take_turns_in_the_queue(database: Database) -> None:
    anns = [add_model(database, maker="ann") for _ in range(3)]
    bobs = [add_model(database, maker="bob") for _ in range(2)]
    with database.writing() as session:
        note_turn(session, wait_for_turn(session), anns[0])  # Ann was served last
    with database.reading() as session:
        found = queries.queue_positions(session, ModelRow, [row.number for row in (*anns, *bobs)])
    order = sorted(found, key=lambda number: found[number])
    assert order == [row.number for row in (bobs[0], anns[0], bobs[1], anns[1], anns[2])]


def test_the_usual_time_is_the_median_of_late_and_a_guess_before(database: Database) -> None:
    with database.reading() as session:
        assert queries.usual_seconds(session, ModelRow) > 0
    for seconds in (2.0, 3.0, 100.0):
        add_model(database, status="succeeded", started=50.0, finished=50.0 + seconds)
    add_model(database, status="succeeded", finished=5.0)  # answered from another one
    with database.reading() as session:
        assert queries.usual_seconds(session, ModelRow) == 3.0


def test_only_a_finished_model_answers_for_another(database: Database) -> None:
    for status in ("queued", "running", "failed", "canceled"):
        add_model(database, status=status, fingerprint="same")
    with database.reading() as session:
        assert queries.finished(session, ModelRow, "same", "treestroke") is None
    made = add_model(database, status="succeeded", fingerprint="same")
    with database.reading() as session:
        found = queries.finished(session, ModelRow, "same", "treestroke")
        assert queries.finished(session, ModelRow, "same", "another engine") is None
    assert found is not None
    assert found.id == made.id


def test_blobs_that_rows_refer_to_are_found_by_how_their_names_begin(database: Database) -> None:
    photo = PhotoRow(id="pho_1", sha256="", width=1, height=1, blob=f"ab{'0' * 62}", created=0.0)
    model = add_model(database, parts={"photo": f"ab{'1' * 62}", "strokes": f"cd{'2' * 62}", "fruit": f"ff{'f' * 62}"})
    with database.writing() as session:
        session.add_all([photo, File(model=model.id, name="tree.glb", blob=f"ab{'3' * 62}", bytes=1)])
    with database.reading() as session:
        assert {name[2] for name in queries.referenced(session, "ab")} == {"0", "1", "3"}
        assert queries.referenced(session, f"cd{'2' * 62}") == {f"cd{'2' * 62}"}
        assert queries.referenced(session, f"cd{'3' * 62}") == set()
        assert queries.referenced(session, "ff") == {f"ff{'f' * 62}"}
        assert len(queries.referenced(session)) == 5


@SQLITE_ONLY  # whose plans do not depend on how many rows there are
def test_no_question_reads_a_whole_table(database: Database) -> None:
    row = add_model(database)
    with planned() as steps, database.reading() as session:
        queries.finished(session, ModelRow, row.fingerprint, row.engine)
        queries.usual_seconds(session, ModelRow)
        queries.queue_positions(session, ModelRow, [row.number])
        queries.page(session, ModelRow, "10", 20)
        queries.model(session, row.id)
        queries.photo(session, "pho_1")
        queries.files(session, [row.id])
        queries.parts(session, [row.id])
        queries.referenced(session, "ab")
    assert len(steps) > 7
    assert scans(steps) == []
    assert any("ix_models_fingerprint (fingerprint=? AND team=? AND engine=? AND status=?)" in step for step in steps)
    assert any("ix_models_times (status=? AND started>?)" in step for step in steps)
    assert any("files USING INDEX ix_files_team (team=? AND model=?)" in step for step in steps)  # not all of a team's


@SQLITE_ONLY  # as above
def test_the_newest_are_read_from_the_end(database: Database) -> None:
    with planned() as steps, database.reading() as session:
        queries.page(session, ModelRow, None, 20)
    # From the end of the team's, and no more than there are on a page: nothing is sorted.
    assert steps == ["SEARCH models USING INDEX ix_models_team (team=?)"]

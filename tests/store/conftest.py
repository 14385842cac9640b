"""What is tested of the store is tested on SQLite and on Postgres."""

import pytest
from tests.postgres import KINDS


@pytest.fixture(params=KINDS)
def database_kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)

from dataclasses import fields
from typing import Any

import pytest
from pydantic import ValidationError

from treestroke.core.errors import SettingsError
from treestroke.core.pipeline import settings as table
from treestroke.core.pipeline.settings import Several, settings_from
from treestroke.wire_requests import FormRequest, ModelSettings

VALUES = [0, 1, 2, 16, 17, 0.1, 0.3, 3, 3.5, 150, 151, 2000, -1, True, "auto", "none", "oak", "bare", [], ["obj"], None]


@pytest.mark.parametrize("name", [entry.name for entry in fields(table.ModelSettings)])
@pytest.mark.parametrize("value", [*VALUES, float("nan"), float("inf"), ["obj", "txt"], {}, "5"], ids=str)
def test_the_model_of_settings_takes_what_their_table_allows(name: str, value: Any) -> None:
    def accepts(read: Any) -> bool:
        try:
            read({name: value})
        except (SettingsError, ValidationError):
            return False
        return True

    assert accepts(ModelSettings.model_validate) == accepts(settings_from)


def test_the_model_of_settings_documents_default_meaning_and_choices() -> None:
    documented = ModelSettings.model_json_schema()["properties"]
    for entry in fields(table.ModelSettings):
        schema, allowed = documented[entry.name], entry.metadata["allowed"]
        default = list(entry.default) if isinstance(entry.default, tuple) else entry.default
        assert (schema["default"], schema["description"]) == (default, entry.metadata["meaning"])
        if isinstance(allowed, Several):
            assert schema["items"]["enum"] == list(allowed.names)


def test_a_form_is_documented_as_text_and_files() -> None:
    form = FormRequest.model_json_schema()
    assert {field["type"] for field in form["properties"].values()} == {"string"}
    assert form["additionalProperties"] is False
    assert "$defs" not in form

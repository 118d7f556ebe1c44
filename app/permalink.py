"""Permalink: an address that leads to exactly one trial, edits included, and back from it to the command."""

from __future__ import annotations

import base64
import binascii
import json
import zlib
from typing import Any
from urllib.parse import urlencode

from pydantic import ValidationError

from app.commands import LARGEST_FILE_CHARS, Restart
from backend.config import explain
from backend.errors import InvalidInputError

PATH = "/open"
PARTS = ("scenario", "seed", "set", "compare", "edits", "file")
LARGEST_EDITS_CHARS = 200_000


def address_of(trial: Restart) -> str:
    """Path and query of ``trial``; readable as far as it is short."""
    query: dict[str, object] = {"scenario": trial.scenario, "seed": trial.seed}
    if trial.overrides:
        query["set"] = json.dumps(trial.overrides, separators=(",", ":"))
    if trial.compare is not None:
        query["compare"] = trial.compare
    if trial.events:
        dumped = [timed.model_dump(mode="json") for timed in trial.events]
        query["edits"] = json.dumps(dumped, separators=(",", ":"))
    if trial.file is not None:
        query["file"] = base64.urlsafe_b64encode(zlib.compress(trial.file.encode(), 9)).decode().rstrip("=")
    return f"{PATH}?{urlencode(query)}"


def trial_at(query: dict[str, str]) -> Restart:
    """The command that a permalink's query asks for; raises ``InvalidInputError`` naming what cannot be used."""
    unknown = sorted(set(query) - set(PARTS))
    if unknown:
        raise InvalidInputError(f"link: {', '.join(unknown)}: no such part. There are {', '.join(PARTS)}.")
    fields: dict[str, Any] = {"scenario": query.get("scenario", ""), "seed": _whole(query.get("seed", "0"))}
    if "set" in query:
        fields["overrides"] = _json("set", query["set"])
    if "compare" in query:
        fields["compare"] = query["compare"]
    if "edits" in query:
        fields["events"] = _json("edits", query["edits"])
    if "file" in query:
        fields["file"] = _unpacked(query["file"])
    try:
        return Restart.model_validate_json(json.dumps({"overrides": {}, **fields}))
    except ValidationError as error:
        raise InvalidInputError(explain(error, "link")) from None


def _whole(text: str) -> object:
    return int(text) if text.isdecimal() and len(text) < 12 else text


def _json(part: str, text: str) -> object:
    if len(text) > LARGEST_EDITS_CHARS:
        raise InvalidInputError(f"link: {part}: longer than {LARGEST_EDITS_CHARS} characters.")
    try:
        return json.loads(text)
    except (json.JSONDecodeError, RecursionError):
        raise InvalidInputError(f"link: {part}: not JSON. The link has lost a part of itself; copy it again.") from None


def _unpacked(text: str) -> str:
    """Never more than a scenario file may have, whatever the packed text claims."""
    try:
        packed = base64.b64decode(text + "=" * (-len(text) % 4), altchars=b"-_", validate=True)
        unpacker = zlib.decompressobj()
        plain = unpacker.decompress(packed, LARGEST_FILE_CHARS + 1)
        if not unpacker.eof:
            raise InvalidInputError(f"link: file: longer than {LARGEST_FILE_CHARS} characters, or cut off.")
        return plain.decode()
    except (binascii.Error, zlib.error, UnicodeDecodeError, ValueError):
        raise InvalidInputError("link: file: cannot be unpacked. The link has lost a part; copy it again.") from None

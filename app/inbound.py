"""What a browser may say to viser: a viewer's messages, never those that open tunnels or set internals."""

from __future__ import annotations

import math
from typing import cast

import msgspec

LARGEST_UPLOAD_BYTES = 256 * 1024
ALLOWED = frozenset(
    {
        "ViewerCameraMessage",
        "GuiUpdateMessage",
        "GuiFormSubmitMessage",
        "GuiFormDirtyMessage",
        "CommandTriggerMessage",
        "ScenePointerMessage",
        "SceneNodeClickMessage",
        "SceneNodeDragMessage",
        "TransformControlsUpdateMessage",
        "TransformControlsDragStartMessage",
        "TransformControlsDragEndMessage",
        "GetRenderResponseMessage",
        "LocalStorageGetItemResponseMessage",
        "FileTransferStartUpload",
        "FileTransferPart",
    }
)


def is_allowed(raw: bytes) -> bool:
    """Whether ``raw`` is a well-formed viewer message of a kind that this page uses."""
    try:
        message: object = msgspec.msgpack.decode(raw)
    except msgspec.DecodeError:
        return False
    if not isinstance(message, dict):
        return False
    fields = cast("dict[object, object]", message)
    if fields.get("type") not in ALLOWED or not _is_finite(fields):
        return False
    if fields["type"] == "GuiUpdateMessage":
        updates = fields.get("updates")
        return isinstance(updates, dict) and set(cast("dict[object, object]", updates)) == {"value"}
    return _is_small(fields)


def _is_small(fields: dict[object, object]) -> bool:
    """Whether an upload is no larger than a scenario file may be, and what is stored no longer than we store."""
    match fields:
        case {
            "type": "FileTransferStartUpload",
            "part_count": int(parts),
            "size_bytes": int(size),
            "filename": str(name),
        }:
            return 0 <= parts <= 1 and 0 <= size <= LARGEST_UPLOAD_BYTES and len(name) <= 200
        case {"type": "FileTransferPart", "content": bytes(content), "part_index": 0}:
            return len(content) <= LARGEST_UPLOAD_BYTES
        case {"type": "LocalStorageGetItemResponseMessage", "value": str(value)}:
            return len(value) <= 200
        case {"type": "FileTransferStartUpload" | "FileTransferPart"}:
            return False
        case _:
            return True


def _is_finite(value: object) -> bool:
    """Whether no number anywhere in ``value`` is NaN or infinite."""
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, dict):
        return all(map(_is_finite, cast("dict[object, object]", value).values()))
    if isinstance(value, list):
        return all(map(_is_finite, cast("list[object]", value)))
    return True

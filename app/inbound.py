"""What a browser may say to viser: a viewer's messages, whole and of bounded size; never what opens tunnels."""

from __future__ import annotations

import math
from typing import Annotated, Literal, cast

import msgspec
from msgspec import Meta

LARGEST_UPLOAD_BYTES = 256 * 1024
LARGEST_MESSAGE_BYTES = LARGEST_UPLOAD_BYTES + 4096
"""Of the websocket; a longer one ends the connection."""

Name = Annotated[str, Meta(max_length=200)]
Text = Annotated[str, Meta(max_length=1000)]
Point = tuple[float, float, float]
Pixel = tuple[float, float]
Scalar = bool | int | float | Text | None
Modifier = Name | None


class Said(msgspec.Struct, tag_field="type", forbid_unknown_fields=True):
    """A message as viser's own browser page writes it."""


class Camera(Said, tag="ViewerCameraMessage"):
    wxyz: tuple[float, float, float, float]
    position: Point
    fov: float
    near: float
    far: float
    image_height: int
    image_width: int
    look_at: Point
    up_direction: Point


class Value(msgspec.Struct, forbid_unknown_fields=True):
    """The only property of a widget that a browser may set."""

    value: Scalar | Annotated[list[Scalar], Meta(max_length=16)]


class Update(Said, tag="GuiUpdateMessage"):
    uuid: Name
    updates: Value


class Trigger(Said, tag="CommandTriggerMessage"):
    uuid: Name


class Click(Said, tag="SceneNodeClickMessage"):
    name: Name
    instance_index: int | None
    ray_origin: Point
    ray_direction: Point
    screen_pos: Pixel
    modifier: Modifier
    owner: Name = ""


class Drag(Said, tag="SceneNodeDragMessage"):
    phase: Literal["start", "update", "end"]
    name: Name
    instance_index: int | None
    start_position: Point
    start_screen_pos: Pixel
    end_position: Point
    end_screen_pos: Pixel
    button: Literal["left", "middle", "right"]
    modifier: Modifier
    owner: Name = ""


class Gizmo(Said, tag="TransformControlsUpdateMessage"):
    name: Name
    wxyz: tuple[float, float, float, float]
    position: Point
    owner: Name = ""


class GizmoGrabbed(Said, tag="TransformControlsDragStartMessage"):
    name: Name
    owner: Name = ""


class GizmoDropped(Said, tag="TransformControlsDragEndMessage"):
    name: Name
    owner: Name = ""


class Stored(Said, tag="LocalStorageGetItemResponseMessage"):
    value: Name | None
    error: Text | None
    request_uuid: Name


class UploadStart(Said, tag="FileTransferStartUpload"):
    source_component_uuid: Name
    transfer_uuid: Name
    filename: Name
    mime_type: Name
    part_count: Annotated[int, Meta(ge=0, le=1)]
    size_bytes: Annotated[int, Meta(ge=0, le=LARGEST_UPLOAD_BYTES)]


class UploadPart(Said, tag="FileTransferPart"):
    source_component_uuid: Name | None
    transfer_uuid: Name
    part_index: Annotated[int, Meta(ge=0, le=0)]
    content: Annotated[bytes, Meta(max_length=LARGEST_UPLOAD_BYTES)]


Allowed = (
    Camera | Update | Trigger | Click | Drag | Gizmo | GizmoGrabbed | GizmoDropped | Stored | UploadStart | UploadPart
)


def is_allowed(raw: bytes) -> bool:
    """Whether ``raw`` is a whole viewer message of a kind that this page uses, with finite numbers only."""
    try:
        msgspec.msgpack.decode(raw, type=Allowed)
        return _is_finite(msgspec.msgpack.decode(raw))
    except (msgspec.DecodeError, RecursionError):
        return False


def _is_finite(value: object) -> bool:
    """Whether no number anywhere in ``value`` is NaN or infinite."""
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, dict):
        return all(map(_is_finite, cast("dict[object, object]", value).values()))
    if isinstance(value, list):
        return all(map(_is_finite, cast("list[object]", value)))
    return True

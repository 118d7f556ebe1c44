"""A viewer without a browser: it speaks viser's protocol well enough to see and to set every widget."""

from __future__ import annotations

import time
from collections.abc import Generator
from contextlib import contextmanager
from typing import Any, cast

import msgspec
import viser
import zstandard
from websockets.sync.client import connect
from websockets.sync.connection import Connection
from websockets.typing import Subprotocol

PROTOCOL = Subprotocol(f"viser-v{viser.__version__}")
Message = dict[str, Any]


class ViewerClient:
    """Collects every message it gets."""

    def __init__(self, socket: Connection) -> None:
        self._socket = socket
        self.messages: list[Message] = []
        self.received_bytes = 0
        camera = {"position": [3.0, 3.0, 3.0], "wxyz": [1.0, 0.0, 0.0, 0.0], "look_at": [0.0, 0.0, 0.0]}
        lens = {"fov": 1.0, "near": 0.1, "far": 100.0, "image_height": 720, "image_width": 1280}
        self.send("ViewerCameraMessage", **camera, **lens, up_direction=[0.0, 0.0, 1.0])

    def send(self, kind: str, **fields: object) -> None:
        """Say anything, allowed or not."""
        self.say(msgspec.msgpack.encode({"type": kind, **fields}))

    def say(self, raw: bytes) -> None:
        """Send bytes as they are."""
        self._socket.send(raw)

    def say_text(self, text: str) -> None:
        """Send a message of the kind that viewers never send."""
        self._socket.send(text)

    def receive(self, timeout_s: float = 1.0) -> None:
        """Take in one batch; none when nothing comes."""
        try:
            raw = self._socket.recv(timeout_s)
        except TimeoutError:
            return
        assert isinstance(raw, bytes)
        self.received_bytes += len(raw)
        packed = int.from_bytes(raw[8:16], "little")
        inner = zstandard.ZstdDecompressor().decompress(raw[16 : 16 + packed])
        self.messages += cast("list[Message]", msgspec.msgpack.decode(inner)["messages"])

    def wait_for(self, kind: str, patience_s: float = 20.0, **fields: object) -> Message:
        """The first message of that type with those fields, among those that have come and those to come."""
        deadline, seen = time.monotonic() + patience_s, 0
        while True:
            for message in self.messages[seen:]:
                if message["type"] == kind and all(message.get(k) == v for k, v in fields.items()):
                    return message
            seen = len(self.messages)
            assert time.monotonic() < deadline, f"no {kind} {fields}"
            self.receive()

    def widget(self, kind: str, label: str, patience_s: float = 20.0) -> str:
        """Uuid of the widget of that type and label."""
        deadline = time.monotonic() + patience_s
        while True:
            for message in self.messages:
                if message["type"] == kind and message["props"].get("label") == label:
                    return str(message["uuid"])
            assert time.monotonic() < deadline, f"no {kind} {label!r}"
            self.receive()

    def set(self, uuid: str, value: object) -> None:
        """Set a widget's value as a browser would, whatever its bounds."""
        self.send("GuiUpdateMessage", uuid=uuid, updates={"value": value})

    def notice(self, patience_s: float = 20.0) -> tuple[str, str]:
        """Title and body of the next notification, which is then forgotten."""
        message = self.wait_for("NotificationShowMessage", patience_s)
        self.messages.remove(message)
        return message["props"]["title"], message["props"]["body"]

    def notice_saying(self, words: str) -> None:
        """Wait for a notification with these words; those before it are forgotten too."""
        while words not in self.notice()[1]:
            pass


@contextmanager
def view(authority: str, **headers: str) -> Generator[ViewerClient]:
    """Connect through the proxy."""
    with connect(
        f"ws://{authority}/viewer",
        subprotocols=[PROTOCOL],
        additional_headers=headers,
        compression=None,
        max_size=None,
        proxy=None,
        close_timeout=1.0,
    ) as socket:
        yield ViewerClient(socket)

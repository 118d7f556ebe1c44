"""Laws of who gets in and what is taken in: nobody foreign, and nothing that breaks the server."""

from __future__ import annotations

import random
import socket
from collections.abc import Iterator
from typing import Any

import httpx
import msgspec
import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from schemathesis import GenerationMode
from schemathesis.core.result import Ok
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from app.guard import Hosts, hosts_of
from app.headers import policy
from app.inbound import LARGEST_MESSAGE_BYTES, LARGEST_UPLOAD_BYTES, is_allowed
from app.main import LARGEST_BODY_BYTES
from app.proxy import BURST, MOST_HZ, Pace
from app.settings import Settings, read_settings
from app.ui.start import KEY_HEADER, start_viser
from backend.errors import InvalidInputError
from tests.app.served import Served, serve, wait_for
from tests.app.viewer_client import PROTOCOL, view

pytestmark = [pytest.mark.timeout(240), pytest.mark.xdist_group("served")]
TOKEN = "correct; horse=battery"
SLOW = (HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large)
PATHS = ("", "viewer/", "api/v1/session", "api/v1/events", "api/docs", "api/openapi.json", "assets/page.js", "open")


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with serve("--paused", "--no-auto-next", "--no-tour") as server:
        yield server


@pytest.fixture(scope="module")
def locked() -> Iterator[Served]:
    with serve("--paused", "--token", TOKEN) as server:
        yield server


def works(served: Served) -> None:
    """It still does what it is there for, whatever it was told before."""
    served.command(kind="set_paused", paused=True)
    served.command(kind="restart", scenario="ur5_linear", seed=1)
    wait_for(served, seed=1, loading=False, simulation="running")
    tick = int(str(wait_for(served, tick=0)["tick"]))
    served.command(kind="step_once")
    wait_for(served, tick=tick + 1)
    with view(served.authority) as viewer:
        viewer.wait_for("MeshMessage", name="/object/body")


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://[", "https://127.0.0.1", "file://"])
def test_no_foreign_origin_enters_anywhere(served: Served, path: str, origin: str) -> None:
    answer = httpx.get(served.address + path, headers={"Origin": origin})
    assert answer.status_code == 403 and "another site" in answer.json()["error"]


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "localhost.evil.example:80", "[", "", "::"])
def test_no_foreign_name_for_this_machine_enters_anywhere(served: Served, path: str, host: str) -> None:
    answer = httpx.get(served.address + path, headers={"Host": host})
    assert answer.status_code == 403 and "answers to" in answer.json()["error"]


@pytest.mark.parametrize("headers", [{"Origin": "http://evil.example"}, {"Origin": "http://["}, {"Origin": "null"}])
def test_no_foreign_page_opens_the_websocket(served: Served, headers: dict[str, str]) -> None:
    with pytest.raises(InvalidStatus, match="403"), view(served.authority, **headers):
        pass


def test_no_foreign_name_opens_the_websocket(served: Served) -> None:
    port = served.authority.split(":")[1]
    sock = socket.create_connection(("127.0.0.1", int(port)))
    with pytest.raises(InvalidStatus, match="403"):
        connect(f"ws://evil.example:{port}/viewer", sock=sock, subprotocols=[PROTOCOL], proxy=None)


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize(
    "offered",
    [
        {},
        {"Authorization": "Bearer wrong"},
        {"Authorization": f"Bearer {TOKEN}x"},
        {"Authorization": f"Bearer {TOKEN[:-1]}"},
        {"Authorization": "Bearer " + "\u00fc\u00ff"},
        {"Cookie": "grasping_token=wrong"},
        {"Cookie": 'grasping_token="'},
        {"Cookie": "\u00e9=\u00e9; ="},
        {"Cookie": "grasping_token="},
    ],
)
def test_no_wrong_token_enters_anywhere(locked: Served, path: str, offered: dict[str, str]) -> None:
    headers = {name.encode(): value.encode("latin-1") for name, value in offered.items()}
    answer = httpx.get(locked.address + path, headers=headers)
    assert answer.status_code == 401 and "?token=" in answer.json()["error"]
    assert TOKEN not in answer.text and "set-cookie" not in answer.headers


def test_viser_itself_lets_in_nobody_but_the_dashboard() -> None:
    server = start_viser("the key")
    port = server.get_port()
    try:
        assert httpx.get(f"http://127.0.0.1:{port}/").status_code == 403
        for headers in ({}, {KEY_HEADER: "another"}, {"Origin": f"http://127.0.0.1:{port}"}):
            with pytest.raises(InvalidStatus, match="403"):
                connect(f"ws://127.0.0.1:{port}", subprotocols=[PROTOCOL], additional_headers=headers, proxy=None)
        with connect(
            f"ws://127.0.0.1:{port}", subprotocols=[PROTOCOL], additional_headers={KEY_HEADER: "the key"}, proxy=None
        ) as known:
            assert known.recv(5.0)
    finally:
        server.stop()


def test_no_wrong_token_opens_the_websocket(locked: Served) -> None:
    for headers in ({}, {"Cookie": "grasping_token=wrong"}, {"Authorization": "Bearer wrong"}):
        with pytest.raises(InvalidStatus, match="403"), view(locked.authority, **headers):
            pass
    with pytest.raises(InvalidStatus, match="403"):
        connect(f"ws://{locked.authority}/viewer?token=wrong", subprotocols=[PROTOCOL], proxy=None)


def test_the_printed_link_lets_in_once_and_leaves_a_cookie_no_script_and_no_other_site_can_use(locked: Served) -> None:
    answer = httpx.get(locked.address, params={"token": TOKEN})
    assert answer.status_code == 303 and "token" not in answer.headers["location"]
    cookie = answer.headers["set-cookie"].lower()
    assert "httponly" in cookie and "samesite=strict" in cookie
    with httpx.Client(cookies=answer.cookies) as browser:
        assert browser.get(locked.address + "api/v1/health").status_code == 200
    assert httpx.get(locked.address, params={"token": TOKEN + "x"}).status_code == 401


def test_every_answer_forbids_browsers_what_this_page_does_not_need(served: Served, locked: Served) -> None:
    answers = [httpx.get(served.address + path) for path in PATHS if path != "api/v1/events"]
    answers += [httpx.get(served.address + "nowhere"), httpx.get(locked.address)]
    answers += [httpx.get(served.address, headers={"Host": "evil.example"})]
    for answer in answers:
        rules = answer.headers["content-security-policy"]
        assert "default-src 'none'" in rules and "frame-ancestors 'none'" in rules
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["referrer-policy"] == "same-origin"
        assert answer.headers["x-frame-options"] == "DENY"
    script = next(part for part in policy("abc").split("; ") if part.startswith("script-src"))
    assert "unsafe-inline" not in script and "'unsafe-eval'" not in script and "http" not in script


@pytest.mark.parametrize(
    ("flags", "header", "included"),
    [
        ((), "localhost:8080", True),
        ((), "127.0.0.1", True),
        ((), "10.0.0.7", False),
        ((), "lab.example", False),
        (("--host", "::1"), "[::1]:80", True),
        (("--host", "0.0.0.0"), "10.0.0.7:8080", True),
        (("--host", "0.0.0.0"), "[fe80::1]:8080", True),
        (("--host", "0.0.0.0"), "lab.example", False),
        (("--host", "0.0.0.0"), "10.0.0.7.lab.example", False),
        (("--host", "0.0.0.0"), socket.gethostname(), True),
        (("--host", "0.0.0.0", "--host-names", "other, Lab.example"), "LAB.example:8080", True),
    ],
)
def test_a_server_answers_to_its_own_names_only(flags: tuple[str, ...], header: str, included: bool) -> None:
    settings = read_settings((*flags, "--token", TOKEN), {})
    assert hosts_of(settings).include(header) is included


@given(st.text())
def test_no_host_header_breaks_the_check(header: str) -> None:
    assert Hosts(frozenset({"never"}), addresses=False).include(header) in (False, header.lower().startswith("never"))


@pytest.mark.parametrize("token", ["short", "with\nnewline", "gr\u00fc\u00dfe aus fern", "x" * 300])
def test_a_token_that_no_cookie_could_carry_is_refused_at_the_start(token: str) -> None:
    with pytest.raises(InvalidInputError, match="token"):
        read_settings(("--token", token), {})
    with pytest.raises(InvalidInputError, match="add --token"):
        read_settings(("--host", "192.168.0.1"), {})
    assert Settings().host == "127.0.0.1"


@pytest.mark.parametrize(
    "path",
    [
        "assets/../run_server.py",
        "assets/..%2frun_server.py",
        "assets/%2e%2e/run_server.py",
        "assets/..%5crun_server.py",
        "assets//etc/passwd",
        "assets/%2fetc/passwd",
        "assets/%00",
        "assets/" + "a" * 5000,
        "viewer/../../etc/passwd",
        "viewer/%2e%2e/%2e%2e/etc/passwd",
        "open?scenario=../../etc/passwd",
        "open?scenario=/etc/passwd",
        "open?scenario=%00",
    ],
)
def test_no_path_leads_to_a_file(served: Served, path: str) -> None:
    host, port = served.authority.split(":")
    with socket.create_connection((host, int(port)), timeout=10.0) as raw:
        raw.sendall(f"GET /{path} HTTP/1.1\r\nHost: {served.authority}\r\nConnection: close\r\n\r\n".encode())
        answer = b"".join(iter(lambda: raw.recv(65536), b""))
    assert int(answer.split()[1]) in (400, 404, 422)
    assert b"root:" not in answer and b"def main" not in answer


def test_a_body_larger_than_any_command_is_refused_whether_it_says_so_or_not(served: Served) -> None:
    address = served.address + "api/v1/session/commands"
    told = httpx.post(address, content=b"x" * (LARGEST_BODY_BYTES + 1), headers={"Content-Type": "application/json"})
    assert told.status_code == 413

    def endless() -> Iterator[bytes]:
        for _ in range(64):
            yield b" " * 65536

    try:
        untold = httpx.post(address, content=endless(), headers={"Content-Type": "application/json"})
        assert untold.status_code == 413
    except httpx.TransportError:
        pass  # cut off amid it, which is as well
    works(served)


def test_a_websocket_message_larger_than_any_upload_ends_the_connection(served: Served) -> None:
    assert LARGEST_MESSAGE_BYTES > LARGEST_UPLOAD_BYTES
    with view(served.authority) as viewer:
        viewer.wait_for("MeshMessage", name="/object/body")
        viewer.send("FileTransferPart", content=b"x" * LARGEST_MESSAGE_BYTES)
        with pytest.raises(ConnectionClosed, match="1009"):
            while True:
                viewer.receive()
    works(served)


def garbage(chance: random.Random) -> bytes:
    """A message as no viewer writes it: noise, a cut-off one, one with a twist, or a very deep one."""
    good = msgspec.msgpack.encode(
        {"type": chance.choice(["GuiUpdateMessage", "ViewerCameraMessage", "CommandTriggerMessage"]), "uuid": "x"}
    )
    value: object = chance.choice([None, {}, [], "x" * 5000, -1, 2**63, 1e308, True, [[[]]], {"a": {"b": 1}}])
    twisted = {"type": "GuiUpdateMessage", "uuid": value, "updates": {"value": value, "visible": value}}
    return chance.choice(
        [
            chance.randbytes(chance.randrange(200)),
            good[: chance.randrange(len(good))],
            msgspec.msgpack.encode(twisted),
            msgspec.msgpack.encode(
                {"type": chance.choice(["ShareUrlRequest", "", "Message", "__class__"]), "a": value}
            ),
            msgspec.msgpack.encode(value),
            b"\x91" * chance.randrange(10_000),
            b"\x81\xa1a" * chance.randrange(10_000),
        ]
    )


def malformed(chance: random.Random, authority: str) -> bytes:
    """A request as no browser writes it."""
    method = chance.choice(["GET", "POST", "PUT", "OPTIONS", "HEAD", "BREW", "G\x00T", ""])
    path = chance.choice(
        ["/", "/viewer", "/viewer/", "/open?edits=[[[", "/api/v1/session/commands", "/%", "/\xff", "*"]
    )
    version = chance.choice(["HTTP/1.1", "HTTP/1.0", "HTTP/9.9", "", "HTTP/1.1"])
    lines = [f"Host: {chance.choice([authority, 'evil.example', '[', ''])}"]
    lines += chance.choices(
        [
            "Content-Length: -1",
            "Content-Length: 99999999999999999999",
            "Content-Length: 10\r\nContent-Length: 20",
            "Transfer-Encoding: chunked",
            "Transfer-Encoding: gzip, chunked",
            "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: x\r\nSec-WebSocket-Version: 99",
            "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: a b, \xff",
            "Content-Type: application/json",
            "Cookie: " + "a=b; " * chance.randrange(50),
            "Authorization: \xff",
            "X-Visitor: " + "\xfc" * chance.randrange(300),
            "Range: bytes=9-1",
            "no colon at all",
            "X: " + "y" * chance.randrange(200_000),
        ],
        k=chance.randrange(4),
    )
    head = "\r\n".join([f"{method} {path} {version}", *lines, "", ""]).encode("latin-1")
    return head + chance.choice([b"", chance.randbytes(300), b'{"kind": "restart", "scenario": {"a": [}', b"5\r\nab"])


def test_two_hundred_malformed_messages_and_requests_are_no_errors_of_the_server(served: Served) -> None:
    chance = random.Random(20261122)
    host, port = served.authority.split(":")
    statuses: list[int] = []
    for number in range(100):
        with socket.create_connection((host, int(port)), timeout=10.0) as raw:
            raw.sendall(malformed(chance, served.authority))
            raw.shutdown(socket.SHUT_WR)
            answer = b""
            while b"\r\n" not in answer and (part := raw.recv(65536)):
                answer += part
        if answer:
            statuses.append(int(answer.split()[1]))
        with view(served.authority) as viewer:
            for _ in range(1 + number % 3):
                noise = garbage(chance)
                assert not is_allowed(noise), noise[:200]
                viewer.say(noise)
            viewer.say_text("not even bytes")
            viewer.wait_for("MeshMessage", name="/object/body")
    assert len(statuses) > 60 and max(statuses) < 500
    works(served)


def test_whoever_sends_too_much_is_heard_later() -> None:
    pace = Pace()
    waits = [pace.debt_s(now_s=100.0) for _ in range(BURST + 2 * MOST_HZ)]
    assert max(waits[: BURST - 1]) == 0.0
    assert waits[-1] == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize("mode", list(GenerationMode))
def test_nothing_that_the_api_is_asked_is_an_error_of_the_server(served: Served, mode: GenerationMode) -> None:
    schema = schemathesis.openapi.from_url(served.address + "api/openapi.json")
    found = schema.exclude(path="/api/v1/events").get_all_operations()
    operations = [each.ok() for each in found if isinstance(each, Ok)]
    assert len(operations) > 8
    asked = [each for each in operations if each.body] if mode is GenerationMode.NEGATIVE else operations
    assert asked
    for operation in asked:
        ask_everything(operation.as_strategy(generation_mode=mode))
    assert httpx.get(served.address + "api/v1/events", params={"rate_hz": "nan"}).status_code == 422


def ask_everything(cases: st.SearchStrategy[Any]) -> None:
    """Ask what fits the API's description, or by its generation mode what does not."""

    @settings(max_examples=60, deadline=None, derandomize=True, database=None, suppress_health_check=SLOW)
    @given(cases)
    def ask(case: Any) -> None:
        if (case.method, case.path) == ("POST", "/api/v1/runs"):
            case.query = {**(case.query or {}), "dry_run": "true"}  # a grid that really starts would outlast the test
        answer = case.call(timeout=10.0)
        assert answer.status_code < 500, answer.text

    ask()


def test_the_server_still_works_after_all_that(served: Served) -> None:
    works(served)
    assert served.process.poll() is None

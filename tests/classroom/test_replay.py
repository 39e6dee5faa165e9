"""A recorded session that is sent to the router again opens no session and moves no robot."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterator

import hostile
import msgspec
import pytest
from cable import Cable
from class_router import Answering, ClassRouter, replies
from patient_connections import PATIENCE_S, patiently

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.contract._generated import keys

COMMAND = keys.command("bea1", "hw", "ana")


@pytest.fixture
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    with ClassRouter(tmp_path_factory.mktemp("class")) as made:
        yield made


def send_again(router: ClassRouter, pieces: list[bytes]) -> int:
    """Send the pieces one by one, each after the reply to the one before; return the number of bytes received."""
    received_bytes = 0
    with (
        contextlib.suppress(ConnectionError),
        socket.create_connection(("127.0.0.1", router.classroom.port + 1), PATIENCE_S) as connection,
    ):
        for piece in pieces[:-1]:
            connection.sendall(piece)
            connection.settimeout(0.3)
            with contextlib.suppress(TimeoutError):
                received_bytes += len(connection.recv(4096))
        connection.settimeout(PATIENCE_S)
        connection.sendall(pieces[-1])
        while data := connection.recv(4096):  # until the router closes it
            received_bytes += len(data)
    return received_bytes


def test_a_replayed_session_opens_no_session_and_repeats_no_request(router: ClassRouter) -> None:
    served = Answering(router.session("bea1"), keys.command("bea1", "hw", "*"))
    router.settled(router.session("bea1"))
    account = router.account("ana")
    with Cable("127.0.0.1", router.classroom.port + 1) as cable:
        endpoint = f"tls/127.0.0.1:{cable.port}"
        relayed = msgspec.structs.replace(account, connect=endpoint)
        with patiently(lambda: zbus.connect(endpoint, account=relayed)) as session:
            token = keys.seat("ana", session.session_id)
            session.declare_token(token)
            assert replies(session, COMMAND), "the recording has a request that is carried out"
            recorded = bytes(max(cable.recorded, key=len))
            for pieces in ([recorded], hostile.frames(recorded)[:3]):
                send_again(router, pieces)
            assert replies(session, COMMAND), "the copy does not end the original session"
    teacher = router.session("teacher")
    for pieces in ([recorded], hostile.frames(recorded)):
        assert send_again(router, pieces) > 0, "the router begins a handshake, and ends it"
        assert token not in teacher.tokens(keys.seat("*", "*"), PATIENCE_S)
    assert served.asked == [COMMAND] * 2, "the recorded request has not been carried out again"
    assert replies(router.session("ana"), COMMAND)

"""What goes over DDS: pushes, and the calibration that a robot is to use. By the C interface of librigcal."""
from __future__ import annotations

import ctypes as c
import json
import os
from types import TracebackType
from typing import Any, Iterable

from .questions import Questions
from .values import Calibration, Document, Edge, MeasuredPose, PushResult, RigcalError, SensorPose, Standing

# The codes of rigcal/c_api.h.
CODES = ("good", "invalid_input", "not_found", "conflict", "busy", "unreachable", "unsupported", "storage", "internal")


class _Options(c.Structure):
    _fields_ = [("domain", c.c_int), ("tag", c.c_char_p), ("timeout_s", c.c_double)]


class _Standing(c.Structure):
    _fields_ = [("revision", c.c_int64), ("verdict", c.c_char_p), ("drive_rule", c.c_char_p)]


class _PushOptions(c.Structure):
    _fields_ = [("no_wait", c.c_int), ("new_robot", c.c_int), ("give_up_s", c.c_double), ("remounted", c.c_char_p)]


class _PushResult(c.Structure):
    _fields_ = [("id", c.c_char_p), ("items", c.c_int64), ("total", c.c_int64), ("held_before", c.c_int64), ("standing", _Standing),
                ("remarks", c.c_char_p)]


class _Calibration(c.Structure):
    _fields_ = [("revision", c.c_int64), ("digest", c.c_char_p), ("reference", c.c_char_p), ("sensor_count", c.c_size_t), ("sensors", c.c_void_p)]


# Each function with what it gives and takes; `handle` is a pointer whose struct is the library's own.
_handle, _text = c.c_void_p, c.c_char_p
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "rigcal_version": (_text, []),
    "rigcal_open": (_handle, [c.POINTER(_Options)]),
    "rigcal_close": (None, [_handle]),
    "rigcal_error": (_text, [_handle]),
    "rigcal_text": (_text, [_handle]),
    "rigcal_ask": (c.c_int, [_handle, _text, _text]),
    "rigcal_push_session": (c.c_int, [_handle, _text, c.POINTER(_PushOptions), c.POINTER(_PushResult)]),
    "rigcal_push_edge_document": (c.c_int, [_handle, _text, _text, c.POINTER(_PushOptions), c.POINTER(_PushResult)]),
    "rigcal_follow": (_handle, [_handle, _text]),
    "rigcal_next": (c.c_int, [_handle, c.c_double, c.POINTER(_Calibration), c.POINTER(c.c_int)]),
    "rigcal_unfollow": (None, [_handle]),
}


def _load() -> c.CDLL:
    name = os.environ.get("RIGCAL_LIBRARY", "librigcal.so.0")
    try:
        library = c.CDLL(name)
    except OSError as missing:
        raise RigcalError("unsupported", f"{name} can't be loaded ({missing}). Install the package librigcal0; questions go without it, "
                          "by rigcal.Server.") from None
    for function, (gives, takes) in _FUNCTIONS.items():
        getattr(library, function).restype, getattr(library, function).argtypes = gives, takes
    return library


def _plain(text: bytes | None) -> str:
    return (text or b"").decode()


class Client(Questions):
    """A way to the server over DDS. Used by one thread at a time, and closed at the end of `with`, or by close()."""

    def __init__(self, domain: int = 0, tag: str = "", timeout_s: float = 5.0) -> None:
        self._library = _load()
        self._client = self._library.rigcal_open(c.byref(_Options(domain, tag.encode(), timeout_s)))

    def close(self) -> None:
        """After what follows through it. Twice is as once."""
        self._library.rigcal_close(self._client)
        self._client = None

    def __enter__(self) -> Client:
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def ask(self, verb: str, **parameters: Any) -> Document:
        self._check(self._library.rigcal_ask(self._open(), verb.encode(), json.dumps(parameters).encode()))
        return self._document()

    def push_session(self, folder: str | os.PathLike[str], *, wait: bool = True, new_robot: bool = False, give_up_s: float = 60.0,
                     remounted: Iterable[str] = ()) -> PushResult:
        """A folder of docs/session-format.md. Broken off, the same call goes on where it was; again it changes nothing."""
        options = _PushOptions(not wait, new_robot, give_up_s, ",".join(remounted).encode())
        return self._push(self._library.rigcal_push_session, os.fsencode(folder), options=options)

    def push_edges(self, robot: str, edges: Iterable[Edge], *, wait: bool = True, new_robot: bool = False, give_up_s: float = 60.0) -> PushResult:
        """Finished edges, in one batch; likewise."""
        document = {"format": 1, "edges": [edge.document() for edge in edges]}
        return self.push_edge_document(robot, document, wait=wait, new_robot=new_robot, give_up_s=give_up_s)

    def push_edge_document(self, robot: str, document: Document, *, wait: bool = True, new_robot: bool = False,
                           give_up_s: float = 60.0) -> PushResult:
        """The same of a document of docs/edges-format.md, which has more members."""
        options = _PushOptions(not wait, new_robot, give_up_s, None)
        return self._push(self._library.rigcal_push_edge_document, robot.encode(), json.dumps(document).encode(), options=options)

    def follow(self, robot: str) -> Follower:
        """The calibration that the robot is to use, and what becomes of it."""
        return Follower(self, robot)

    def _push(self, function: Any, *what: bytes, options: _PushOptions) -> PushResult:
        told = _PushResult()
        self._check(function(self._open(), *what, c.byref(options), c.byref(told)))
        standing = Standing(told.standing.revision, _plain(told.standing.verdict), _plain(told.standing.drive_rule))
        return PushResult(_plain(told.id), told.items, told.total, told.held_before, standing, _plain(told.remarks), self._document())

    def _open(self) -> int:
        if self._client is None:
            raise RigcalError("invalid_input", "The client is closed. Open another one.")
        return int(self._client)

    def _document(self) -> Document:
        return dict(json.loads(self._library.rigcal_text(self._open())) or {})

    def _check(self, code: int) -> None:
        if code:
            raise RigcalError(CODES[code], _plain(self._library.rigcal_error(self._open())))


class Follower:
    """Of one robot, by Client.follow(). The client outlives it."""

    def __init__(self, client: Client, robot: str) -> None:
        self._client, self._library = client, client._library
        self._follower = self._library.rigcal_follow(client._open(), robot.encode())
        if not self._follower:
            raise RigcalError("invalid_input", _plain(self._library.rigcal_error(client._open())))

    def close(self) -> None:
        """Before its client. Twice is as once."""
        self._library.rigcal_unfollow(self._follower)
        self._follower = None

    def __enter__(self) -> Follower:
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def next(self, timeout_s: float) -> Calibration | None:
        """At first what is in use now, then each change; None where none came in time. After an error what was told last still holds."""
        self._client._open()
        if not self._follower:
            raise RigcalError("invalid_input", "It is closed. Follow the robot again.")
        told, news = _Calibration(), c.c_int()
        self._client._check(self._library.rigcal_next(self._follower, timeout_s, c.byref(told), c.byref(news)))
        if not news.value:
            return None
        rows = self._client._document().get("sensors", [])
        poses = tuple(SensorPose(row["id"], MeasuredPose.of_document(row["T_ref_sensor"], row["covariance"])) for row in rows)
        return Calibration(told.revision, _plain(told.digest), _plain(told.reference), poses)

"""Questions of docs/api.md: over HTTP in Python alone, and what the answers are whichever way they came."""
from __future__ import annotations

import json
import urllib.error
import urllib.parse
import urllib.request
from abc import ABC, abstractmethod
from typing import Any

from .values import Document, Lookup, MeasuredPose, RigcalError, Standing


class Questions(ABC):
    @abstractmethod
    def ask(self, verb: str, **parameters: Any) -> Document:
        """The document of docs/api.md that answers `verb`; RigcalError where it can't be had."""

    def robots(self) -> list[Document]:
        """A row for each robot of the fleet."""
        return list(self.ask("robots")["robots"])

    def show(self, robot: str, revision: int = 0) -> Document:
        """A revision whole: sensors, edges, verdict. 0: the newest."""
        return self.ask("show", robot=robot, **({"revision": revision} if revision else {}))

    def lookup(self, robot: str, a: str, b: str, revision: int = 0) -> Lookup:
        """The pose of sensor b in sensor a; 0: of the revision in use, RigcalError "conflict" where none is."""
        told = self.ask("lookup", robot=robot, a=a, b=b, **({"revision": revision} if revision else {}))
        return Lookup(MeasuredPose.of_document(told["T_a_b"], told["covariance"]), Standing.of_document(told["verdict"], told), told)


class Server(Questions):
    """A server's HTTP: `Server("http://127.0.0.1:8420")`. It answers questions; pushes and orders go over DDS (`Client`)."""

    def __init__(self, address: str, timeout_s: float = 5.0) -> None:
        self.address = address.rstrip("/")
        self.timeout_s = timeout_s

    def ask(self, verb: str, **parameters: Any) -> Document:
        words = {name: ("true" if value else "false") if isinstance(value, bool) else value for name, value in parameters.items()}
        address = f"{self.address}/api/v1/{urllib.parse.quote(verb)}?{urllib.parse.urlencode(words)}"
        try:
            with urllib.request.urlopen(address, timeout=self.timeout_s) as reply:
                return dict(json.load(reply))
        except urllib.error.HTTPError as refused:
            raise error_of(refused.read(), f"{self.address} answers '{verb}' with {refused.code}") from None
        except (OSError, ValueError) as away:
            raise RigcalError("unreachable", f"No rigcald answers at {self.address}: {away}. Start it with `rigcald --data DIR --http HOST:PORT`, "
                              "or correct the address.") from None


def error_of(body: bytes, otherwise: str) -> RigcalError:
    """Of an answer that is docs/api.md's error document; `otherwise` where it is none."""
    try:
        told = json.loads(body)["error"]
        return RigcalError(told["code"], f"{told['what']}. {told['cure'].rstrip('.')}.")
    except (ValueError, KeyError, TypeError, AttributeError):
        return RigcalError("unreachable", otherwise + ". Look at the address: it may be another server's.")

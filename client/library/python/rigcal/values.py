"""What goes in and comes out. p_a = T_a_b * p_b; metres and radians; q_xyzw Hamilton. A covariance has the order
[x y z rx ry rz] and belongs to T * Exp(xi), in the axes of b."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Mapping, Sequence

Row = tuple[float, ...]
Matrix = tuple[Row, ...]
Document = Mapping[str, Any]  # of docs/api.md


class RigcalError(Exception):
    """One sentence that names what is wrong and its cure. `code`: "not_found", "unreachable", ... as in docs/api.md."""

    def __init__(self, code: str, sentence: str) -> None:
        super().__init__(sentence)
        self.code = code


def _check_rigid(T: Sequence[Sequence[float]]) -> None:
    def refuse(what: str) -> None:
        raise RigcalError("invalid_input", "a 4 x 4 matrix is no pose: %s. Give [R p; 0 1] with R a rotation and p in metres." % what)
    if len(T) != 4 or any(len(row) != 4 for row in T):
        refuse("it has not four rows of four numbers")
    if not all(math.isfinite(value) for row in T for value in row):
        refuse("a number is not finite")
    if tuple(T[3]) != (0, 0, 0, 1):
        refuse("its last row is not 0 0 0 1")
    for i in range(3):
        for j in range(3):
            if abs(sum(T[i][k] * T[j][k] for k in range(3)) - (i == j)) > 1e-3:  # of numbers that somebody copied
                refuse("its rows are not at right angles and of length 1")
    if sum(T[2][k] * (T[0][(k + 1) % 3] * T[1][(k + 2) % 3] - T[0][(k + 2) % 3] * T[1][(k + 1) % 3]) for k in range(3)) < 0:
        refuse("it mirrors")


@dataclass(frozen=True)
class Pose:
    p_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    q_xyzw: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)

    def matrix(self) -> Matrix:
        """[R p; 0 1] as four rows."""
        x, y, z, w = self.q_xyzw
        return ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), self.p_m[0]),
                (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), self.p_m[1]),
                (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), self.p_m[2]),
                (0.0, 0.0, 0.0, 1.0))

    @staticmethod
    def of_matrix(T: Sequence[Sequence[float]]) -> Pose:
        """Of [R p; 0 1] where R is a rotation; by the largest component of q (Shepperd 1978), w >= 0. RigcalError where R is none to 1e-3."""
        _check_rigid(T)
        xx, yy, zz = T[0][0], T[1][1], T[2][2]
        yz, zx, xy = T[2][1] - T[1][2], T[0][2] - T[2][0], T[1][0] - T[0][1]
        rows = ((1 + xx - yy - zz, T[0][1] + T[1][0], T[0][2] + T[2][0], yz), (T[0][1] + T[1][0], 1 - xx + yy - zz, T[1][2] + T[2][1], zx),
                (T[0][2] + T[2][0], T[1][2] + T[2][1], 1 - xx - yy + zz, xy), (yz, zx, xy, 1 + xx + yy + zz))
        largest = rows[max(range(4), key=lambda i: rows[i][i])]
        length = math.copysign(math.hypot(*largest), largest[3])
        x, y, z, w = (part / length for part in largest)
        return Pose((float(T[0][3]), float(T[1][3]), float(T[2][3])), (x, y, z, w))


@dataclass(frozen=True)
class MeasuredPose:
    pose: Pose
    covariance: Matrix

    @staticmethod
    def of_document(T: Document | None, covariance: Sequence[Sequence[float]] | None) -> MeasuredPose | None:
        """Nothing where a direction of it was not measured."""
        if T is None or covariance is None:
            return None
        (x_m, y_m, z_m), (x, y, z, w) = T["p_m"], T["q_xyzw"]
        return MeasuredPose(Pose((x_m, y_m, z_m), (x, y, z, w)), tuple(tuple(row) for row in covariance))


@dataclass(frozen=True)
class Standing:
    """What a revision is worth: "pass", "warn", "fail" or "unknown", and whether the robot may drive by it. `revision` 0: there is none."""
    revision: int = 0
    verdict: str = "unknown"
    drive_rule: str = ""

    @staticmethod
    def of_document(verdict: Document, told: Document) -> Standing:
        """`told`: the document that has `revision` and `drive`."""
        rule = (told.get("drive") or {}).get("rule", "")
        return Standing(told["revision"], verdict["level"], rule + "." if rule else "")


@dataclass(frozen=True)
class Lookup:
    T_a_b: MeasuredPose | None
    standing: Standing
    document: Document = field(repr=False)


@dataclass(frozen=True)
class SensorPose:
    sensor: str
    T_ref_sensor: MeasuredPose | None


@dataclass(frozen=True)
class Calibration:
    """`revision` 0: none is in use, and the robot is not to go by any. `digest` is the sha256 of the revision's document."""
    revision: int
    digest: str
    reference: str
    sensors: tuple[SensorPose, ...]


@dataclass(frozen=True)
class Edge:
    """A pairwise result of another tool. Of `covariance` and `information` the one that is known; the second may be singular."""
    frame_a: str
    frame_b: str
    T_a_b: Pose
    covariance: Sequence[Sequence[float]] | None = None
    information: Sequence[Sequence[float]] | None = None
    dof: int = 0
    method: str = "given"
    measured_at: str | None = None

    def document(self) -> dict[str, Any]:
        """As docs/edges-format.md has it."""
        T = {"p_m": list(self.T_a_b.p_m), "q_xyzw": list(self.T_a_b.q_xyzw)}
        told: dict[str, Any] = {"frame_a": self.frame_a, "frame_b": self.frame_b, "T_a_b": T, "dof": self.dof, "method": self.method}
        for name, matrix in (("covariance", self.covariance), ("information", self.information)):
            if matrix is not None:
                told[name] = [[float(value) for value in row] for row in matrix]
        if self.measured_at is not None:
            told["measured_at"] = self.measured_at
        return told


@dataclass(frozen=True)
class PushResult:
    """`id` of the session or batch; `items`: files or edges; `total` and `held_before`: bytes or edges. `remarks`, for people: what was stored,
    and what looks odd in it."""
    id: str
    items: int
    total: int
    held_before: int
    standing: Standing
    remarks: str
    document: Document = field(repr=False)

"""Pushes pairwise results that this program made, and tells what the rig looks like with them: push_edges.py ROBOT"""
import sys

import rigcal

COVARIANCE = [[1e-6 if row == column else 0.0 for column in range(6)] for row in range(6)]  # 1 mm and 1 mrad in each axis


def in_front(a: str, b: str, x_m: float) -> rigcal.Edge:
    """As if measured: b stands `x_m` in front of a."""
    return rigcal.Edge(a, b, rigcal.Pose((x_m, 0.0, 0.0)), covariance=COVARIANCE, dof=12, method="ruler")


def main(robot: str) -> None:
    with rigcal.Client() as client:
        pushed = client.push_edges(robot, [in_front("a", "b", 1.0), in_front("b", "c", 1.0), in_front("a", "c", 2.003)])
        print(f"batch {pushed.id}: {pushed.items} edges, {pushed.held_before} were there before")
        print(f"revision {pushed.standing.revision}: {pushed.standing.verdict}. {pushed.standing.drive_rule}")
        found = client.lookup(robot, "b", "c", pushed.standing.revision).T_a_b
        if found is not None:
            print(f"c is {found.pose.matrix()[0][3]:.4f} m in front of b, sigma {1e3 * found.covariance[0][0] ** 0.5:.2f} mm")


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except rigcal.RigcalError as error:
        sys.exit(str(error))

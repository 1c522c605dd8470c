"""On a robot: prints the calibration that it is to use, and anew at each change, COUNT times: follow.py ROBOT COUNT"""
import sys

import rigcal


def show(calibration: rigcal.Calibration) -> None:
    if calibration.revision == 0:
        print("no calibration is in use", flush=True)
    for row in calibration.sensors:
        where = "not known whole" if row.T_ref_sensor is None else " ".join(f"{value:.6f}" for value in row.T_ref_sensor.pose.p_m)
        print(f"revision {calibration.revision} {row.sensor} in {calibration.reference} {where}", flush=True)


def main(robot: str, count: int) -> None:
    with rigcal.Client() as client, client.follow(robot) as follower:
        while count > 0:
            try:
                calibration = follower.next(60.0)
            except rigcal.RigcalError as error:
                print(error, file=sys.stderr)  # what was told last still holds
                if error.code != "unreachable":
                    raise
                continue
            if calibration is not None:
                show(calibration)
                count -= 1


if __name__ == "__main__":
    try:
        main(sys.argv[1], int(sys.argv[2]))
    except rigcal.RigcalError as error:
        sys.exit(str(error))

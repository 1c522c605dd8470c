"""Sends a session folder and waits for its calibration: push_session.py FOLDER. Break it off and run it again when you like."""
import sys

import rigcal


def main(folder: str) -> None:
    with rigcal.Client() as client:
        pushed = client.push_session(folder)
        print(f"session {pushed.id}: {pushed.items} files")
        print(f"revision {pushed.standing.revision}: {pushed.standing.verdict}. {pushed.standing.drive_rule}")


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except rigcal.RigcalError as error:
        sys.exit(str(error))

"""What each robot of the fleet is worth, over HTTP and without librigcal: fleet.py http://HOST:PORT"""
import sys

import rigcal


def main(address: str) -> None:
    server = rigcal.Server(address)
    for row in server.robots():
        newest = server.show(row["robot"]) if row["revision"] else None
        rule = newest["drive"]["rule"] if newest else "nothing was calibrated yet"
        print(f"{row['robot']}: {rule}")
        if newest:
            print("  " + ", ".join(sensor["id"] for sensor in newest["document"]["sensors"]))


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except rigcal.RigcalError as error:
        sys.exit(str(error))

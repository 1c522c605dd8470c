"""What goes wrong with a session folder before it is pushed, and finished edges that agree or do not."""
import math
import random
import shutil

from .verdict_rigs import changed


def declare(session, *changes):
    """Says something else in session.yaml."""
    header = session / "session.yaml"
    header.write_text(changed(header.read_text(), changes))


def exchange(session, a, b):
    """The folders of two sensors."""
    aside = session / "aside"
    for source, target in ((session / a, aside), (session / b, session / a), (aside, session / b)):
        source.rename(target)


def cut_short(session, sensor, size_bytes):
    """Files of which only the beginning was written."""
    for path in (session / sensor).iterdir():
        path.write_bytes(path.read_bytes()[:size_bytes])


def drop_files(session, sensor, from_ratio):
    """From that part of the captures on."""
    files = sorted((session / sensor).iterdir())
    for path in files[int(from_ratio * len(files)):]:
        path.unlink()


def drop_sensors(session, *sensors):
    """They stay listed."""
    for sensor in sensors:
        shutil.rmtree(session / sensor)


def darken(session, sensors):
    """Pictures as with the caps on the lenses: a little noise, another in each."""
    from bad_session import png
    noise, nearly_black = random.Random(1), bytes(value % 4 for value in range(256))
    for sensor in sensors:
        for path in sorted((session / sensor).iterdir()):
            path.unlink()
            path.with_suffix(".png").write_bytes(png(612, 512, [noise.randbytes(612).translate(nearly_black) for _ in range(512)]))


def in_millimetres(session, body):
    """Positions of its poses."""
    path = session / body / "poses.csv"
    header, *rows = [line.split(",") for line in path.read_text().splitlines()]
    rows = [row[:2] + [repr(1e3 * float(value)) for value in row[2:5]] + row[5:] for row in rows]
    path.write_text("".join(",".join(row) + "\n" for row in [header] + rows))


def renamed_captures(session, prefix):
    for path in [one for folder in session.iterdir() if folder.is_dir() for one in folder.iterdir()]:
        path.rename(path.with_name(prefix + path.name))


def edge(a, b, x_m, turn_rad, sigma_m, sigma_rad):
    """b ahead of a, turned about the line between them."""
    variance = [sigma_m ** 2] * 3 + [sigma_rad ** 2] * 3
    return {"frame_a": a, "frame_b": b, "T_a_b": {"p_m": [x_m, 0.0, 0.0], "q_xyzw": [math.sin(turn_rad / 2), 0.0, 0.0, math.cos(turn_rad / 2)]},
            "covariance": [[variance[i] if i == k else 0.0 for k in range(6)] for i in range(6)]}


def chain(names, sigma_m, sigma_rad, step_m=0.5):
    return [edge(a, b, step_m, 0.0, sigma_m, sigma_rad) for a, b in zip(names, names[1:])]


def ring(names, off_m, off_rad, sigmas, sigma_rad=None):
    """Does not close by this much, which is so many sigmas of the whole loop."""
    each_m = off_m / sigmas / math.sqrt(len(names))
    each_rad = sigma_rad or off_rad / sigmas / math.sqrt(len(names))
    edges = chain(names, each_m, each_rad)
    return edges + [edge(names[0], names[-1], 0.5 * len(edges) + off_m, off_rad, each_m, each_rad)]


def weak_ring(names, sigma_m, weak_m):
    """Closed by a pair that says next to nothing."""
    edges = chain(names, sigma_m, sigma_m)
    return edges + [edge(names[0], names[-1], 0.5 * len(edges), 0.0, weak_m, weak_m)]

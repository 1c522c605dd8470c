"""Files of finished edges as another tool writes them."""
import json

IDENTITY = [[1e6 if row == column else 0.0 for column in range(6)] for row in range(6)]


def block_edges(path, count, blocks=40):
    """A chain with loops of `count` edges, each with the results of leaving one capture out."""
    edges = []
    for i in range(count):
        a, b = i, i + 1 + i % 2
        scatter = [[1e-4 * ((7 * i + 3 * k + axis) % 11 - 5) for axis in range(6)] for k in range(blocks)]
        edges.append({"frame_a": "s%d" % a, "frame_b": "s%d" % b, "information": IDENTITY, "source": "jackknife", "dof": blocks - 1,
                      "T_a_b": {"p_m": [float(b - a), 0.001 * (i % 3), 0.0], "q_xyzw": [0.0, 0.0, 0.0, 1.0]},
                      "blocks": [{"block_id": "%03d" % k, "d": d} for k, d in enumerate(scatter)]})
    path.write_text(json.dumps({"format": 1, "edges": edges}))
    return path

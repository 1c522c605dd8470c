"""g2o's own cost of a pose graph at given poses, in plain Python: an oracle that shares nothing with the server."""


def product(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def rotated(q, v):
    x, y, z, w = q
    tx, ty, tz = 2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])
    return (v[0] + w * tx + y * tz - z * ty, v[1] + w * ty + z * tx - x * tz, v[2] + w * tz + x * ty - y * tx)


def inverse_times(a, b):
    """a^-1 b of poses (p, q_xyzw)."""
    conjugate = (-a[1][0], -a[1][1], -a[1][2], a[1][3])
    difference = tuple(b[0][i] - a[0][i] for i in range(3))
    return rotated(conjugate, difference), product(conjugate, b[1])


def normalised(q):
    norm = sum(value * value for value in q) ** 0.5
    return tuple(value / norm for value in q)


def edge_cost(fields, poses):
    """fields: the words of an EDGE_SE3:QUAT line after the tag."""
    values = [float(word) for word in fields[2:]]
    measured = (tuple(values[:3]), normalised(values[3:7]))
    p, q = inverse_times(measured, inverse_times(poses[fields[0]], poses[fields[1]]))
    sign = -1.0 if q[3] < 0 else 1.0
    error = list(p) + [sign * q[0], sign * q[1], sign * q[2]]
    cost, k = 0.0, 7
    for row in range(6):
        for column in range(row, 6):
            cost += (1.0 if row == column else 2.0) * values[k] * error[row] * error[column]
            k += 1
    return cost


def g2o_cost(path, document):
    poses = {}
    for sensor in document["sensors"]:
        pose = sensor["T_ref_sensor"]
        poses[sensor["id"]] = (tuple(pose["p_m"]), tuple(pose["q_xyzw"]))
    lines = (line.split() for line in open(path))
    return sum(edge_cost(fields[1:], poses) for fields in lines if fields and fields[0] == "EDGE_SE3:QUAT")

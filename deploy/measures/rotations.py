"""Rotations and poses in plain Python. Quaternions are x y z w; matrices are rows; a pose is (p, q), of b in a."""
import math


def of_vector(v):
    """The quaternion of a rotation vector."""
    angle = math.sqrt(sum(x * x for x in v))
    ratio = math.sin(angle / 2) / angle if angle > 1e-12 else 0.5
    return [ratio * x for x in v] + [math.cos(angle / 2)]


def times(a, b):
    """The product of two quaternions."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def back(q):
    return [-q[0], -q[1], -q[2], q[3]]


def turned(q, v):
    return times(times(q, list(v) + [0.0]), back(q))[:3]


def composed(a, b):
    """The pose of c in a, of those of b in a and of c in b."""
    (p_a, q_a), (p_b, q_b) = a, b
    return [p_a[i] + t for i, t in enumerate(turned(q_a, p_b))], times(q_a, q_b)


def inverse(pose):
    p, q = pose
    return [-x for x in turned(back(q), p)], back(q)


def matrix_of(q):
    x, y, z, w = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]


def of_rpy(rpy_rad):
    """The matrix of roll, pitch and yaw: about x, then y, then z, all of a."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(a), math.cos(a)) for a in rpy_rad)
    return [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr]]


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transposed(a):
    return [list(row) for row in zip(*a)]

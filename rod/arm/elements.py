"""A geometrically exact beam element with one point: forces on its two nodes, and their derivatives.

Between the nodes a and b, with places r, frames R and the rest length h,

    Theta = log(R_a^T R_b),   k = Theta / h,   R_m = R_a exp(Theta / 2),   v = R_m^T (r_b - r_a) / h,

and the energy is h w(k, v). In the plane the frames are angles, and the angle in the middle is the mean of both.
J. C. Simo, L. Vu-Quoc, Comput. Methods Appl. Mech. Eng. 58 (1986) 79; one point leaves no locking, and errors of h^2.

Nodes move by u and turn by psi (R -> exp(psi) R). With q = psi_b - psi_a, p = (psi_a + psi_b) / 2 and d = u_b - u_a in
the middle frame,

    delta Theta = S q,    delta R_m: mu = p - T q / 2,    delta v = d / h + v x mu,
    S = I + (1 - (theta/2) / sin(theta/2)) [Theta]^2 / theta^2,    T = tan(theta/4) [Theta] / theta.

The second derivatives are those along exp(t psi), which are symmetric. Forces of the iteration before stand in the part
of the tangent that comes from the motion of the frame: with stiff stretch Newton's method then needs fewer steps
(D. Magisano et al., Int. J. Numer. Meth. Engng 110 (2017) 237).
"""

import math

from geometry.arrays import Array
from rod.arm import rotations
from rod.arm.rotations import cross_into, exponential, multiply, multiply_transposed, skew

#: rad, below which the functions of an angle are given by their series
SMALL = 1e-2


def plane_element(
    h: float, state: Array, force: Array, stiffness: Array, inner: Array, gradient: Array, hessian: Array
) -> None:
    """Gradient (6,) and Hessian (6, 6) by x, y and angle of both nodes.

    state: (5,) angle in the middle, strains kappa, stretch and shear (the last entry is unused); force: (3,) moment,
    axial and shear force; stiffness: (3, 3); inner: (2,) axial and shear force in the geometric part.
    """
    c, s = math.cos(state[0]), math.sin(state[0])
    stretch, shear = state[2], state[3]
    moment, N, Q = force[0], force[1], force[2]
    fx, fy = c * N - s * Q, s * N + c * Q
    half = 0.5 * h * (N * shear - Q * stretch)
    gradient[0], gradient[1], gradient[2] = -fx, -fy, half - moment
    gradient[3], gradient[4], gradient[5] = fx, fy, half + moment
    k00, k01, k02 = stiffness[0, 0] / h, stiffness[0, 1], stiffness[0, 2]
    k11, k12, k22 = stiffness[1, 1], stiffness[1, 2], stiffness[2, 2]
    # by the turn q between the nodes, their distance (d1, d2) in the middle frame, and the mean turn t
    qd1, qd2 = k01 / h, k02 / h
    qt = k01 * shear - k02 * stretch
    d11, d12, d22 = k11 / h, k12 / h, k22 / h
    d1t = k11 * shear - k12 * stretch - inner[1]
    d2t = k12 * shear - k22 * stretch + inner[0]
    tt = h * (
        k11 * shear * shear
        - 2.0 * k12 * shear * stretch
        + k22 * stretch * stretch
        - inner[0] * stretch
        - inner[1] * shear
    )
    xx = c * c * d11 - 2.0 * c * s * d12 + s * s * d22
    xy = c * s * (d11 - d22) + (c * c - s * s) * d12
    yy = s * s * d11 + 2.0 * c * s * d12 + c * c * d22
    qx, qy = c * qd1 - s * qd2, s * qd1 + c * qd2
    tx, ty = c * d1t - s * d2t, s * d1t + c * d2t
    for i in range(2):
        sign = -1.0 if i == 0 else 1.0
        x, y, turn = 3 * i, 3 * i + 1, 3 * i + 2
        for j in range(2):
            other = -1.0 if j == 0 else 1.0
            both = sign * other
            hessian[x, 3 * j] = both * xx
            hessian[x, 3 * j + 1] = hessian[y, 3 * j] = both * xy
            hessian[y, 3 * j + 1] = both * yy
            hessian[x, 3 * j + 2] = hessian[3 * j + 2, x] = sign * (other * qx + 0.5 * tx)
            hessian[y, 3 * j + 2] = hessian[3 * j + 2, y] = sign * (other * qy + 0.5 * ty)
            hessian[turn, 3 * j + 2] = both * k00 + 0.5 * (sign + other) * qt + 0.25 * tt


def turn_functions(angle: float, out: Array) -> None:
    """Functions (8,) of the angle theta of an element.

    (1 - (theta/2)/sin(theta/2)) / theta^2, tan(theta/4)/theta, b = (1 - (theta/2) cot(theta/2)) / theta^2, b'/theta,
    and with x = theta/2: a_2 = (x - sin x)/x^3, a_2'/x, -a_1'/x, a_1 = (1 - cos x)/x^2.
    """
    t2 = angle * angle
    if angle < SMALL:
        x2 = 0.25 * t2
        out[0] = -1.0 / 24.0 - 7.0 * t2 / 5760.0
        out[1] = 0.25 + t2 / 192.0
        out[2] = 1.0 / 12.0 + t2 / 720.0
        out[3] = 1.0 / 360.0 + t2 / 7560.0
        out[4] = 1.0 / 6.0 - x2 / 120.0
        out[5] = -1.0 / 60.0 + x2 / 1260.0
        out[6] = 1.0 / 12.0 - x2 / 180.0
        out[7] = 0.5 - x2 / 24.0
        return
    x = 0.5 * angle
    sine, cosine, x2 = math.sin(x), math.cos(x), x * x
    out[0] = (1.0 - x / sine) / t2
    out[1] = math.tan(0.25 * angle) / angle
    out[2] = (1.0 - x * cosine / sine) / t2
    # b = (1 - x cot x) / (4 x^2), b' by theta is half that by x
    by_x = (-cosine / sine + x / (sine * sine)) / (4.0 * x2) - 2.0 * (1.0 - x * cosine / sine) / (4.0 * x2 * x)
    out[3] = 0.5 * by_x / angle
    out[4] = (x - sine) / (x2 * x)
    out[5] = ((1.0 - cosine) - 3.0 * (x - sine) / x) / (x2 * x2)
    out[6] = -(sine - 2.0 * (1.0 - cosine) / x) / (x2 * x)
    out[7] = (1.0 - cosine) / x2


def space_element(
    h: float,
    frame: Array,
    state: Array,
    stiffness: Array,
    inner: Array,
    work: Array,
    gradient: Array,
    hessian: Array,
) -> None:
    """Gradient (12,) and Hessian (12, 12) by place and turn of both nodes, along x, y and z.

    frame: (3, 3) in the middle; state: (15,) six strains, moment and force, and Theta; stiffness: (6, 6); inner: (3,)
    force in the geometric part; work: (16, 3, 3), overwritten.
    """
    f, v, m, turn = work[15].reshape(9), state[3:6], state[6:9], state[12:15]
    _spins(h, turn, v, work, f)
    # what a turn q changes: moment and force
    V, A, G, by_m, by_n = work[3], work[4], work[5], work[6], work[7]
    for i in range(3):
        for j in range(3):
            a = b = 0.0
            for k in range(3):
                a += stiffness[i, k] * A[k, j] + stiffness[i, 3 + k] * G[k, j]
                b += stiffness[3 + i, k] * A[k, j] + stiffness[3 + i, 3 + k] * G[k, j]
            by_m[i, j], by_n[i, j] = a, b
    qq, dq, dd, qp, dp, pp = work[8], work[9], work[10], work[11], work[12], work[13]
    for i in range(3):
        for j in range(3):
            a = b = c = 0.0
            for k in range(3):
                a += A[k, i] * by_m[k, j] + G[k, i] * by_n[k, j]
                b += by_n[k, i] * V[k, j]
                c += stiffness[3 + i, 3 + k] * V[k, j]
            qq[i, j], qp[i, j], dp[i, j] = h * a, h * b, c
            dq[i, j] = by_n[i, j]
            dd[i, j] = stiffness[3 + i, 3 + j] / h
    for i in range(3):
        for j in range(3):
            a = 0.0
            for k in range(3):
                a += V[k, i] * dp[k, j]
            pp[i, j] = h * a
    _geometric(h, turn, v, m, inner, work)
    _to_nodes(frame, state, h, work, gradient, hessian)


def _spins(h: float, turn: Array, v: Array, work: Array, f: Array) -> None:
    """[Theta], S, T, [v], and the changes S / h and -[v] T / 2 of the strains with a turn q, at 0 to 5 in work."""
    turn_functions(math.sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]), f)
    spin, S, T, V, A, G = work[0], work[1], work[2], work[3], work[4], work[5]
    skew(turn, spin)
    skew(v, V)
    multiply(spin, spin, S)
    for i in range(3):
        for j in range(3):
            S[i, j] *= f[0]
            T[i, j] = f[1] * spin[i, j]
        S[i, i] += 1.0
    multiply(V, T, G)
    for i in range(3):
        for j in range(3):
            A[i, j] = S[i, j] / h
            G[i, j] *= -0.5


def _geometric(h: float, turn: Array, v: Array, m: Array, n: Array, work: Array) -> None:
    """Add the parts of the blocks that come from the second derivatives of the strains."""
    f, c = work[15].reshape(9), work[14, 0]
    c[0] = h * (n[1] * v[2] - n[2] * v[1])
    c[1] = h * (n[2] * v[0] - n[0] * v[2])
    c[2] = h * (n[0] * v[1] - n[1] * v[0])
    _by_mean_turn(h, v, m, n, work, f[1])
    # second derivative of Theta, seen by m and by half of J_r(Theta/2)^T c
    z = work[14, 1]
    cross_into(c, turn, z)  # X x c with X = Theta/2 is -(c x Theta)/2; J_r^T c = c + a_1 X x c + a_2 X x (X x c)
    other = work[14, 2]
    cross_into(turn, z, other)
    for i in range(3):
        z[i] = m[i] + 0.5 * (c[i] - 0.5 * f[7] * z[i] - 0.25 * f[4] * other[i])
    _second_of_turn(turn, z, work, f)
    _of_middle_frame(turn, work, f)


def _by_mean_turn(h: float, v: Array, m: Array, n: Array, work: Array, tan_part: float) -> None:
    """Add what the mean turn p does with moment and force."""
    spin, S, T, skewed, other = work[0], work[1], work[2], work[3], work[6]  # V and by_m are not needed any more
    qq, dq, qp, dp, pp = work[8], work[9], work[11], work[12], work[13]
    # y = S m, and what the turns p and q do to it
    for i in range(3):
        work[14, 1, i] = S[i, 0] * m[0] + S[i, 1] * m[1] + S[i, 2] * m[2]
    skew(work[14, 1], skewed)
    for i in range(3):
        for j in range(3):
            qp[j, i] += 0.5 * skewed[i, j]
    skew(work[14, 0], skewed)
    multiply(spin, skewed, other)
    for i in range(3):
        for j in range(3):
            qp[j, i] += 0.25 * tan_part * other[i, j]
    # D . (mu x n) with mu = p - T q / 2
    skew(n, skewed)
    multiply(skewed, T, other)
    for i in range(3):
        for j in range(3):
            dp[i, j] -= skewed[i, j]
            dq[i, j] += 0.5 * other[i, j]
    # h n . (mu x (mu x v)) / 2
    M, MT = work[4], work[5]
    nv = n[0] * v[0] + n[1] * v[1] + n[2] * v[2]
    for i in range(3):
        for j in range(3):
            M[i, j] = 0.5 * h * (v[i] * n[j] + n[i] * v[j])
        M[i, i] -= h * nv
    multiply(M, T, MT)
    for i in range(3):
        for j in range(3):
            pp[i, j] += M[i, j]
            qp[i, j] -= 0.5 * MT[j, i]
            qq[i, j] += 0.25 * (T[0, i] * MT[0, j] + T[1, i] * MT[1, j] + T[2, i] * MT[2, j])


def _of_middle_frame(turn: Array, work: Array, f: Array) -> None:
    """Add what the rotation of the middle frame does, to the block of q."""
    S, qq, M, MT = work[1], work[8], work[4], work[5]
    c, x, across, twice = work[14, 0], work[14, 1], work[14, 2], work[7, 0]
    for i in range(3):
        x[i] = 0.5 * turn[i]
    cross_into(c, x, across)
    cross_into(across, x, twice)  # (c x X) x X = X x (X x c)
    along = c[0] * x[0] + c[1] * x[1] + c[2] * x[2]
    for i in range(3):
        for j in range(3):
            one = f[6] * x[i] * across[j] + f[5] * x[i] * twice[j] - f[4] * c[i] * x[j]
            two = f[6] * x[j] * across[i] + f[5] * x[j] * twice[i] - f[4] * c[j] * x[i]
            M[i, j] = 0.5 * (one + two)
        M[i, i] += f[4] * along
    multiply(M, S, MT)
    for i in range(3):
        for j in range(3):
            part = S[0, i] * MT[0, j] + S[1, i] * MT[1, j] + S[2, i] * MT[2, j]
            qq[i, j] += 0.25 * part - 0.125 * f[1] * (c[i] * turn[j] + c[j] * turn[i])
        qq[i, i] += 0.5 * f[1] * along


def _second_of_turn(turn: Array, z: Array, work: Array, f: Array) -> None:
    """Add z . D2 Theta [q, q], symmetric, to the block of q."""
    spin, S, qq = work[0], work[1], work[8]
    inner, other, E = work[3], work[4], work[6]
    zx, zt = work[7], work[5]
    skew(z, zx)
    multiply(zx, spin, inner)
    cross_into(z, turn, work[14, 2])
    skew(work[14, 2], zt)
    for i in range(3):
        for j in range(3):
            inner[i, j] = -0.5 * zx[i, j] - f[2] * (inner[i, j] + zt[i, j])
    half = work[14, 2]
    for i in range(3):
        half[i] = -0.5 * turn[i]
    exponential(half, E)
    multiply(inner, E, other)
    multiply_transposed(S, other, inner)
    # w = [Theta]^2 z, seen through exp(-Theta/2)
    w, seen = zx[0], zx[1]
    first = zx[2]
    cross_into(turn, z, first)
    cross_into(turn, first, w)
    for i in range(3):
        seen[i] = E[0, i] * w[0] + E[1, i] * w[1] + E[2, i] * w[2]
    for i in range(3):
        for j in range(3):
            a = inner[i, j] + f[3] * turn[i] * seen[j]
            b = inner[j, i] + f[3] * turn[j] * seen[i]
            qq[i, j] += 0.5 * (a + b)


def _to_nodes(frame: Array, state: Array, h: float, work: Array, gradient: Array, hessian: Array) -> None:
    """The blocks in the middle frame as gradient and Hessian by the nodes along x, y and z."""
    v, m, n, turn = state[3:6], state[6:9], state[9:12], state[12:15]
    S, tan_part = work[1], work[15].reshape(9)[1]
    qq, dq, dd, qp, dp, pp = work[8], work[9], work[10], work[11], work[12], work[13]
    c, ct, local = work[14, 0], work[14, 1], work[14, 2]
    cross_into(n, v, c)
    for i in range(3):
        c[i] *= h
    cross_into(turn, c, ct)
    # gradient by q: S m - T^T c / 2, by p: c, by d: n
    for i in range(3):
        local[i] = S[i, 0] * m[0] + S[i, 1] * m[1] + S[i, 2] * m[2] + 0.5 * tan_part * ct[i]
    for i in range(3):
        by_d = frame[i, 0] * n[0] + frame[i, 1] * n[1] + frame[i, 2] * n[2]
        by_q = frame[i, 0] * local[0] + frame[i, 1] * local[1] + frame[i, 2] * local[2]
        by_p = frame[i, 0] * c[0] + frame[i, 1] * c[1] + frame[i, 2] * c[2]
        gradient[i], gradient[6 + i] = -by_d, by_d
        gradient[3 + i], gradient[9 + i] = 0.5 * by_p - by_q, 0.5 * by_p + by_q
    turned = work[3]
    for block in range(6):
        one = work[8 + block]
        multiply(frame, one, turned)
        for i in range(3):
            for j in range(3):
                one[i, j] = turned[i, 0] * frame[j, 0] + turned[i, 1] * frame[j, 1] + turned[i, 2] * frame[j, 2]
    for i in range(2):
        sign = -1.0 if i == 0 else 1.0
        for j in range(2):
            other = -1.0 if j == 0 else 1.0
            for a in range(3):
                for b in range(3):
                    hessian[6 * i + a, 6 * j + b] = sign * other * dd[a, b]
                    mixed = sign * (other * dq[a, b] + 0.5 * dp[a, b])
                    hessian[6 * i + a, 6 * j + 3 + b] = mixed
                    hessian[6 * j + 3 + b, 6 * i + a] = mixed
                    hessian[6 * i + 3 + a, 6 * j + 3 + b] = (
                        sign * other * qq[a, b] + 0.5 * sign * qp[a, b] + 0.5 * other * qp[b, a] + 0.25 * pp[a, b]
                    )


def strain_change(h: float, turn: Array, v: Array, d: Array, p: Array, q: Array, out: Array) -> None:
    """Changes (6,) of the strains of an element in space by d, p and q, (3,) each, along its middle frame.

    turn: (3,) Theta; v: (3,) stretch and shears.
    """
    angle2 = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]
    angle = math.sqrt(angle2)
    s_part, tan_part = -1.0 / 24.0 - 7.0 * angle2 / 5760.0, 0.25 + angle2 / 192.0
    if angle >= SMALL:
        s_part, tan_part = (1.0 - 0.5 * angle / math.sin(0.5 * angle)) / angle2, math.tan(0.25 * angle) / angle
    along = turn[0] * q[0] + turn[1] * q[1] + turn[2] * q[2]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        # mu = p - T q / 2
        mu_j = p[j] - 0.5 * tan_part * (turn[k] * q[i] - turn[i] * q[k])
        mu_k = p[k] - 0.5 * tan_part * (turn[i] * q[j] - turn[j] * q[i])
        out[i] = (q[i] + s_part * (turn[i] * along - angle2 * q[i])) / h
        out[3 + i] = d[i] / h + v[j] * mu_k - v[k] * mu_j


#: in the order in which they call each other, innermost first
CALLS = (
    *rotations.CALLS,
    *(turn_functions, _spins, _by_mean_turn, _second_of_turn, _of_middle_frame, _geometric, _to_nodes),
    *(plane_element, space_element, strain_change),
)

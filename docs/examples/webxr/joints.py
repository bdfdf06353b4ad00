"""What the 25 joints of a WebXR hand are in zwang: target poses (docs/stream.md)."""
# The standard hand (bench/scenes/hand.cpp) [m]: length and radius of the phalanxes from thumb to little finger, the widths of the palm, and
# the mean of the knuckles of index .. little finger in the axes of a right palm.
lengths = (50.1, 34.2, 23.5, 43.1, 24.2, 17.1, 48.3, 28.5, 18.8, 44.8, 27.8, 18.7, 35.5, 19.6, 17.3)
bones = {"phalanxes": [(length / 1000, (9 - k % 3) / 1000) for k, length in enumerate(lengths)], "palm": (0.084, 0.096, 0.028)}
knuckles_mean = (0.00375, 0.0425, 0.0)


def turned(q, v):
    """v turned by the quaternion q."""
    x, y, z, w = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]]


def poses_of(joints, left=False):
    """16 poses of docs/stream.md, 7 numbers each, from the 25 joints in XRHand's order, 7 numbers each.

    WebXR: y up; a joint's -z along its bone away from the wrist, y out of the back of the hand. zwang: z up; a bone's y along it, z out of
    its back. So world and joint are turned alike: (x, y, z) -> (x, -z, y), of positions and of the quaternions' vectors. A bone's pose has
    the joint's turn, and lies halfway to the next joint; the palm has the wrist's turn, and its knuckles where the tracked ones are.
    """
    at = [(x, -z, y) for x, y, z, *_ in joints]
    turn = [(x, -z, y, w) for *_, x, y, z, w in joints]
    mean = turned(turn[0], (-knuckles_mean[0] if left else knuckles_mean[0], *knuckles_mean[1:]))
    poses = [(*(sum(at[finger][i] for finger in (6, 11, 16, 21)) / 4 - mean[i] for i in range(3)), *turn[0])]
    for first in (1, 6, 11, 16, 21):  # thumb-metacarpal, *-finger-phalanx-proximal, and the two after each; the tips are no bones
        poses += [(*((a + b) / 2 for a, b in zip(at[j], at[j + 1])), *turn[j]) for j in range(first, first + 3)]
    return poses
